#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace sightline {

/// Makes every option of every command refuse what is mostly a slip: '' as of a shell's variable that is not
/// set, which would count as not given, and the next option's name in the place of a value.
void refuseSlips(CLI::App& app);

/// Throws CLI::ExtrasError for an option with one dash too few: CLI11 takes -output for -o with the value
/// "utput".
void refuseSingleDashes(const CLI::App& app, int argc, char** argv);

/// What is wrong with the words that `app` was given, as one line that names the word, the name that it is
/// nearest to, and the command to ask for help.
std::string usageLine(const CLI::App& app, const CLI::ParseError& error);

}  // namespace sightline
