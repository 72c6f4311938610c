#pragma once
// Checks of names on the command line.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

namespace sightline {

/// A list in which each name stands once: what is named twice would be worked on twice.
inline void requireDistinct(const std::string& option, const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) == name) continue;
    throw CLI::ValidationError(option, fmt::format("{} is named twice; name each once", *name));
  }
}

}  // namespace sightline
