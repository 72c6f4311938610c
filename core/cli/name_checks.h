#pragma once
// Checks of names on the command line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/base/nearest.h"

namespace sightline {

/// One of the names; else the line says which there are, and which is nearest.
inline CLI::Validator oneOf(std::vector<std::string> names) {
  const std::string all = fmt::format("{}", fmt::join(names, ", "));
  const std::string shown = fmt::format("{{{}}}", fmt::join(names, ","));
  return CLI::Validator(
      [names = std::move(names), all](std::string& text) {
        if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
        return fmt::format("{} is none of {}{}", text, all, didYouMean(text, names));
      },
      shown);
}

/// A name other than "-", standard output, for what cannot go there. what: "a .pvs file".
inline CLI::Validator notStandardOutput(const char* what) {
  return CLI::Validator(
      [what](std::string& text) {
        if (text != "-") return std::string();
        return fmt::format("- is standard output, where {} cannot go; give it a name", what);
      },
      "");
}

/// A list in which each name stands once: what is named twice would be worked on twice.
inline void requireDistinct(const std::string& option, const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) == name) continue;
    throw CLI::ValidationError(option, fmt::format("{} is named twice; name each once", *name));
  }
}

}  // namespace sightline
