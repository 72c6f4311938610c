#pragma once
#include <CLI/CLI.hpp>

#include "core/cli/number_checks.h"
#include "core/judge/ruling.h"

namespace sightline {

/// Declares --rounding, which writes into limit; that must live as long as `command`.
inline void declareRounding(CLI::App& command, RoundingLimit& limit) {
  command.add_option("--rounding", limit.steps, "float steps beside an edge that count as rounding")
      ->check(between(0, 1e6))
      ->type_name("STEPS")
      ->capture_default_str();
}

}  // namespace sightline
