#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace sightline {

/// A short name, as of a command, and what is said of it beside it, within 80 columns.
std::string helpEntry(const std::string& name, const std::string& text);

/// CLI11's help within 80 columns: what is said of an option or command wraps between words, in its own
/// column.
class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat();
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
};

}  // namespace sightline
