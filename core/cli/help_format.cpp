#include "core/cli/help_format.h"

#include <sstream>

namespace sightline {
namespace {

constexpr size_t kColumns = 80;
/// Columns of the names of options and of commands; what is said of them has the others.
constexpr size_t kNameColumns = 30, kCommandColumns = 14;

/// The text in lines of at most `columns`; a longer word has a line of its own.
std::string wrapped(const std::string& text, size_t columns) {
  std::string lines, line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > columns) {
      lines += line + '\n';
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

std::string entry(const std::string& name, const std::string& text, size_t name_columns) {
  std::ostringstream out;
  CLI::detail::format_help(out, name, wrapped(text, kColumns - name_columns), name_columns);
  return out.str();
}

}  // namespace

std::string helpEntry(const std::string& name, const std::string& text) {
  return entry(name, text, kCommandColumns);
}

HelpFormat::HelpFormat() {
  label("SUBCOMMAND", "COMMAND");
}

std::string HelpFormat::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
  for (size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

std::string HelpFormat::make_option(const CLI::Option* option, bool is_positional) const {
  const std::string name = make_option_name(option, is_positional) + make_option_opts(option);
  return entry(name, make_option_desc(option), kNameColumns);
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  return helpEntry(command->get_display_name(true), command->get_description());
}

}  // namespace sightline
