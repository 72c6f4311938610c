// What the program says of itself: the commands, their options, and examples that run as they stand.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "core/pvs/param_table.h"
#include "tests/cli/run_program.h"
#include "tests/cli/run_separately.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::Folder;
using test::runProgram;
using test::runSeparately;
using test::SeparateRun;

/// The commands that `sightline help` lists, by name.
std::vector<std::string> listedCommands(const std::string& help) {
  std::vector<std::string> names;
  std::istringstream lines(help.substr(std::min(help.size(), help.find("\nCommands:\n"))));
  for (std::string line; std::getline(lines, line);) {
    if (line.size() < 3 || line[0] != ' ' || line[2] == ' ') continue;
    names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

/// The examples of a command's help, each one line.
std::vector<std::string> examplesOf(const std::string& help) {
  std::vector<std::string> examples;
  std::istringstream lines(help);
  bool goes_on = false;
  for (std::string line; std::getline(lines, line);) {
    const bool starts = line.rfind("  sightline ", 0) == 0;
    if (!starts && !goes_on) continue;
    goes_on = line.back() == '\\';
    if (goes_on) line.pop_back();
    if (starts) examples.emplace_back();
    examples.back() += line.substr(line.find_first_not_of(' '));
  }
  return examples;
}

TEST(Help, IsTheSameHoweverItIsAskedFor) {
  const Folder folder;
  const SeparateRun help = runSeparately("help", folder / "");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.errors, "");
  EXPECT_EQ(help.output, runSeparately("--help", folder / "").output);
  const auto commands = listedCommands(help.output);
  for (const char* name : {"bake", "cells", "compare", "crosscheck", "devices", "diff", "export", "help",
                           "info", "measure", "picture", "scene", "verify"}) {
    EXPECT_EQ(std::count(commands.begin(), commands.end(), name), 1) << name << "\n" << help.output;
  }
  for (const std::string& name : commands) {
    const SeparateRun one = runSeparately("help " + name, folder / "");
    EXPECT_EQ(one.exit_code, 0) << name;
    EXPECT_EQ(one.output, runSeparately(name + " --help", folder / "").output) << name;
    EXPECT_NE(one.output.find("Usage: sightline " + name), std::string::npos) << one.output;
  }
  // Without arguments: the same, as an error.
  const SeparateRun nothing = runSeparately("", folder / "");
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_EQ(nothing.output, "");
  EXPECT_EQ(nothing.errors, help.output);
}

TEST(Help, NamesAnUnknownCommand) {
  const Folder folder;
  const SeparateRun run = runSeparately("help baek", folder / "");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.output, "");
  EXPECT_EQ(run.errors, "sightline: unknown command baek; did you mean bake? (see: sightline --help)\n");
  EXPECT_EQ(runSeparately("help bake cells", folder / "").errors,
            "sightline: unexpected argument cells (see: sightline help --help)\n");
}

/// The list in declareSampling and beside it has all of the table.
TEST(Help, OfBakeHasAnOptionForEachParameter) {
  const std::string help = runProgram("help bake").output;
  for (const Param& param : kParams) {
    EXPECT_NE(help.find("  " + optionOf(param) + " "), std::string::npos) << param.name;
  }
}

/// A terminal has 80 columns, or more.
TEST(Help, FitsATerminal) {
  const std::string help = runProgram("help").output;
  EXPECT_GT(listedCommands(help).size(), 10u) << help;
  std::string all = help;
  for (const std::string& name : listedCommands(help)) {
    all += runProgram("help " + name).output;
  }
  std::istringstream lines(all);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_EQ(all.find("\n\n\n"), std::string::npos);
}

TEST(Help, ExamplesRunAsTheyStand) {
  const Folder scenes, folder;
  const auto run = [](const std::string& example, const Folder& where) {
    // The program's own name stands first, and perhaps after a pipe.
    const SeparateRun done = runSeparately(example.substr(example.find(' ') + 1), where / "");
    EXPECT_EQ(done.exit_code, 0) << example << "\n" << done.errors;
  };
  for (const std::string& example : examplesOf(runProgram("help scene").output)) run(example, scenes);
  run("sightline scene city -o city.glb --triangles 2k", folder);
  run("sightline cells city.glb -o cells.json --path -5.5,1.5,-20 -5.5,1.5,20 --width 2 --length 40", folder);
  for (const char* command : {"bake", "diff", "measure", "compare", "crosscheck"}) {
    const auto examples = examplesOf(runProgram(std::string("help ") + command).output);
    EXPECT_FALSE(examples.empty()) << command;
    for (const std::string& example : examples) run(example, folder);
  }
}

}  // namespace
}  // namespace sightline
