#include <cmath>

#include "core/base/error.h"
#include "core/gvs/bake_cell.h"

namespace sightline {

void checkParams(const BakeParams& p) {
  const auto require = [](bool good, const char* line) {
    if (!good) throw Error(line, kExitUsage);
  };
  require(p.method <= Method::kNaive, "no such method");
  require(p.raster_resolution >= 16 && p.raster_resolution <= kMaxViewResolution,
          "raster-resolution must be 16 .. 16384");
  require(p.target_error == 0 || (p.target_error >= kSmallestTargetError && p.target_error < 1),
          "target-error must be 0 (off) or 1e-10 .. 1");
  require(p.n_rand >= 1 && p.n_rand <= 0xfffffffdu, "n-rand must be 1 .. 4294967293");
  require(p.n_abs_edge <= 1000, "n-abs-edge must be 0 .. 1000");
  require(std::isfinite(p.abs_spacing) && p.abs_spacing >= 0, "abs-spacing must be finite and not negative");
  require(p.reverse_stride >= 1, "reverse-stride must be at least 1");
  require(p.order <= Order::kYield, "no such order");
  require(p.n_rs_edge <= 1000, "n-rs-edge must be 0 .. 1000");
  require(p.n_rs_area <= 100'000, "n-rs-area must be 0 .. 100000");
  require(p.batch_rays >= kFewestBatchRays && p.batch_rays <= 1u << 28,
          "batch-rays must be 4096 .. 268435456");
  require(p.quiet_iterations >= 1, "quiet-iterations must be at least 1");
  require(p.threshold >= 1 || p.max_rays > 0 || p.max_seconds > 0 || p.target_error > 0,
          "threshold 0 never ends: give max-rays, max-seconds or target-error too");
  const auto distance = [](float x) { return std::isfinite(x) && x >= 0; };
  require(distance(p.delta_abs) && distance(p.delta_abs_relative) && p.delta_abs + p.delta_abs_relative > 0,
          "delta-abs and delta-abs-relative must be finite, not negative, and one of them above 0");
  require(distance(p.delta_rs) && distance(p.delta_rs_relative),
          "delta-rs and delta-rs-relative must be finite and not negative");
  require(std::isfinite(p.max_seconds) && p.max_seconds >= 0, "max-seconds must be finite and not negative");
}

void requireMethodOn(Method method, const std::string& device) {
  if (method != Method::kRaster || device.starts_with("vulkan")) return;
  throw Error("the method raster draws by Vulkan: use --device vulkan, not " + device, kExitUsage);
}

}  // namespace sightline
