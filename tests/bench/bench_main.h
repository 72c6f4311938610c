#pragma once
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <functional>

#include "core/base/error.h"

namespace sightline {

/// Parses the command line of a benchmark and does its work; what goes wrong is said in one line. Returns the
/// exit code.
inline int benchMain(CLI::App& app, int argc, char** argv, const std::function<void()>& work) {
  try {
    app.parse(argc, argv);
    work();
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return kExitUsage;
  } catch (const Error& error) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return error.exitCode();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return kExitFailed;
  }
}

}  // namespace sightline
