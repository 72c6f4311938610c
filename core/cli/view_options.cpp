#include "core/cli/view_options.h"

#include <fmt/core.h>

#include "core/cli/number_checks.h"

namespace sightline {

void declareViews(CLI::App& command, ViewOptions& options) {
  const MeasureOptions defaults;
  const auto declare = [&](const char* name, std::optional<uint32_t>& value, const char* what, uint32_t usual,
                           uint32_t on_cpu, uint32_t most) {
    command
        .add_option(name, value,
                    fmt::format("{} (default: {}; where a processor traces, {})", what, usual, on_cpu))
        ->transform(wholeNumber(1, most))
        ->type_name("N");
  };
  declare("--views", options.views, "views of each cell", defaults.views, kViewsOnCpu, kMaxMeasureViews);
  declare("--resolution", options.resolution, "pixels along each side of a view", defaults.resolution,
          kResolutionOnCpu, kMaxMeasureResolution);
}

MeasureOptions chooseViews(const ViewOptions& options, bool on_cpu, MeasureOptions measure) {
  measure.views = options.views.value_or(on_cpu ? kViewsOnCpu : measure.views);
  measure.resolution = options.resolution.value_or(on_cpu ? kResolutionOnCpu : measure.resolution);
  return measure;
}

}  // namespace sightline
