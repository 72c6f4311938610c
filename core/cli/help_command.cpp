#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/base/error.h"
#include "core/base/nearest.h"
#include "core/cli/commands.h"

namespace sightline {
namespace {

void printHelp(const CLI::App& app, const std::string& name) {
  std::string text;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
    if (command->get_name() == name) text = command->help(app.get_name());
  }
  if (name.empty()) {
    // App::help() would be that of the command in work.
    text = app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
  }
  if (text.empty()) {
    throw Error("unknown command " + name + didYouMean(name, names) + " (see: sightline --help)", kExitUsage);
  }
  std::fputs(text.c_str(), stdout);
}

}  // namespace

void addHelpCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("help", "List the commands, or say all about one");
  const auto name = std::make_shared<std::string>();
  command->add_option("command", *name, "one of the commands (default: lists them)")->type_name("COMMAND");
  command->callback([&app, name] { printHelp(app, *name); });
}

}  // namespace sightline
