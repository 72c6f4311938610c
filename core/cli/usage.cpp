#include "core/cli/usage.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "core/base/nearest.h"
#include "core/cli/command_line.h"

namespace sightline {
namespace {

bool looksLikeOption(const std::string& word) {
  return word.size() > 1 && word[0] == '-';
}

/// "--rays=5" -> "--rays".
std::string withoutValue(const std::string& word) {
  return word.substr(0, word.find('='));
}

std::vector<std::string> optionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<std::string> commandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string unknownOption(const CLI::App& command, const std::string& word) {
  const std::string name = withoutValue(word);
  return fmt::format("unknown option {}{}", shellQuoted({&name, 1}), didYouMean(name, optionNames(command)));
}

/// Of an option that takes one value and was given more; empty: there is none.
std::string repeatedOption(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const int most = option->get_items_expected_max();
    if (most > 0 && option->count() > size_t(most)) {
      return fmt::format("{} is given {} times; give it once", option->get_name(), option->count());
    }
  }
  return {};
}

/// Says in our words what CLI11 says in its own; the line is its own where there is nothing to add.
std::string inOurWords(const CLI::App& app, const CLI::App& command, const CLI::ParseError& error) {
  const std::vector<std::string> unused = command.remaining();
  const auto option = std::find_if(unused.begin(), unused.end(), looksLikeOption);
  const bool no_command = &command == &app && !unused.empty() && option != unused.begin();
  if (no_command) {
    return fmt::format("unknown command {}{}", shellQuoted({unused.data(), 1}),
                       didYouMean(unused.front(), commandNames(app)));
  }
  if (option != unused.end()) return unknownOption(command, *option);
  const std::string line = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !unused.empty()) {
    return fmt::format("unexpected argument {}", shellQuoted({unused.data(), 1}));
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string repeated = repeatedOption(command);
    if (!repeated.empty()) return repeated;
    const std::string name = line.substr(0, line.find(':'));
    const CLI::Option* needy = command.get_option_no_throw(name);
    if (needy != nullptr && needy->count() == 0) {
      return fmt::format("{} needs a value: {}", name, needy->get_type_name());
    }
  }
  return line.substr(0, line.find('\n'));
}

}  // namespace

void refuseSlips(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    const std::vector<std::string> names = optionNames(*command);
    for (CLI::Option* option : command->get_options()) {
      const char* empty = option->get_required() ? "is empty; give a value"
                                                 : "is empty; give a value, or leave the option out";
      // transform puts it before the other checks.
      option->transform(CLI::Validator(
          [empty, names](std::string& text) {
            if (text.empty()) return std::string(empty);
            if (std::find(names.begin(), names.end(), text) == names.end()) return std::string();
            return fmt::format("needs a value, and {} is an option", text);
          },
          ""));
    }
  }
}

void refuseSingleDashes(const CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const std::vector<std::string> commands = commandNames(app);
  const auto command = std::find_first_of(words.begin(), words.end(), commands.begin(), commands.end());
  if (command == words.end()) return;
  const std::vector<std::string> names = optionNames(*app.get_subcommand(*command));
  for (const std::string& word : words) {
    if (word == "--") return;
    if (word.size() < 3 || word[0] != '-') continue;
    const std::string meant = "-" + withoutValue(word);
    if (std::find(names.begin(), names.end(), meant) == names.end()) continue;
    throw CLI::ParseError(fmt::format("unknown option {}; did you mean {}?", meant.substr(1), meant),
                          CLI::ExitCodes::ExtrasError);
  }
}

std::string usageLine(const CLI::App& app, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  // What stands before the command was not understood either, and comes first.
  const CLI::App& command = chosen.empty() || !app.remaining().empty() ? app : *chosen.front();
  const std::string name = chosen.empty() ? "" : " " + chosen.front()->get_name();
  return fmt::format("{} (see: sightline{} --help)", inOurWords(app, command, error), name);
}

}  // namespace sightline
