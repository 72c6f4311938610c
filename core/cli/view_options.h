#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

#include "core/measure/pixel_error.h"

namespace sightline {

/// How many views a cell's error is measured by, and how large they are; not given: what the device affords.
struct ViewOptions {
  std::optional<uint32_t> views, resolution;
};

/// Declares --views and --resolution. options must live as long as `command`.
void declareViews(CLI::App& command, ViewOptions& options);

/// `measure` with what was given, and else with the defaults: smaller where a processor traces.
MeasureOptions chooseViews(const ViewOptions& options, bool on_cpu, MeasureOptions measure);

}  // namespace sightline
