#pragma once
#include <CLI/CLI.hpp>

// A command of the program is one file core/cli/NAME_command.cpp that defines
//
//   void addNameCommand(CLI::App& app);   // e.g. cells_command.cpp: addCellsCommand
//
// It adds a subcommand with its options and a callback that does the work (keep the options in a
// std::shared_ptr that the callback holds). CMake finds the files, so there is no list to edit. A callback
// throws Error for what goes wrong; to end with another exit code than 0 it throws ExitCode.
namespace sightline {

/// Ends the program with this code and without a message: everything has been said.
struct ExitCode {
  int code = 0;
};

#define SL_COMMAND(function) void function(CLI::App& app);
#include "generated/commands.inc"
#undef SL_COMMAND

}  // namespace sightline
