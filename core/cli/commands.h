#pragma once
#include <CLI/CLI.hpp>
#include <exception>

// A command of the program is one file core/cli/NAME_command.cpp that defines
//
//   void addNameCommand(CLI::App& app);   // e.g. cells_command.cpp: addCellsCommand
//
// It adds a subcommand with its options and a callback that does the work (keep the options in a
// std::shared_ptr that the callback holds). core/cli/CMakeLists.txt lists the files. A callback
// throws Error for what goes wrong; to end with another exit code than 0 it throws ExitCode.
namespace sightline {

/// Ends the program with this code and without a message: everything has been said.
struct ExitCode : std::exception {
  explicit ExitCode(int exit_code) : code(exit_code) {}
  const char* what() const noexcept override { return "exit"; }
  int code;
};

#define SL_COMMAND(function) void function(CLI::App& app);
#define SL_COMMAND_LEFT_OUT(name, why)
#include "generated/commands.inc"
#undef SL_COMMAND
#undef SL_COMMAND_LEFT_OUT

}  // namespace sightline
