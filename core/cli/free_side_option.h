#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "core/cli/name_checks.h"
#include "core/scene/in_solid.h"

namespace sightline {

/// Declares --free-side, which writes into free_side; that must live as long as `command`.
inline CLI::Option* declareFreeSide(CLI::App& command, FreeSide& free_side, const std::string& help) {
  return command
      .add_option_function<std::string>(
          "--free-side",
          [&free_side](const std::string& name) {
            free_side = name == "front"  ? FreeSide::kFront
                        : name == "back" ? FreeSide::kBack
                                         : FreeSide::kAny;
          },
          help)
      ->check(oneOf({"front", "back", "any"}))
      ->type_name("NAME")
      ->default_str("front");
}

}  // namespace sightline
