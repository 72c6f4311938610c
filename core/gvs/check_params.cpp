#include <fmt/format.h>

#include "core/base/error.h"
#include "core/gvs/bake_cell.h"
#include "core/pvs/param_table.h"

namespace sightline {

static_assert(std::get<ParamField<uint32_t>>(paramOf("raster_resolution").field).high == kMaxViewResolution);

void checkParams(const BakeParams& params) {
  const auto require = [](bool good, const std::string& line) {
    if (!good) throw Error(line, kExitUsage);
  };
  const std::string problem = paramProblem(params);
  require(problem.empty(), problem);
  // What no single one says.
  require(params.threshold >= 1 || params.max_rays > 0 || params.max_seconds > 0 || params.target_error > 0,
          "threshold 0 never ends: give max-rays, max-seconds or target-error too");
  require(params.delta_abs + params.delta_abs_relative > 0,
          "one of delta-abs and delta-abs-relative must be above 0");
  require(params.method != Method::kBound, "the method bound traces no rays: use sightline bound");
  require(params.smallest_hole == 0 || params.method != Method::kRaster,
          "smallest-hole looks at rays, and the method raster draws: use another method");
  require(params.smallest_hole == 0 || params.target_error == 0,
          "target-error counts what is seen through any gap: with smallest-hole use threshold or max-rays");
}

void requireMethodOn(Method method, const std::string& device) {
  if (method != Method::kRaster || device.starts_with("vulkan")) return;
  throw Error("the method raster draws by Vulkan: use --device vulkan, not " + device, kExitUsage);
}

void requireDrawable(Method method, const Scene& scene) {
  if (method != Method::kRaster || scene.surfaces.empty()) return;
  const SurfaceCounts counts = countSurfaces(scene);
  throw Error(
      fmt::format("the method raster draws every triangle as opaque from both sides; of this scene {} have "
                  "holes, {} are glass, {} have no back: use another method",
                  counts.masked, counts.glass, counts.front_only),
      kExitUsage);
}

}  // namespace sightline
