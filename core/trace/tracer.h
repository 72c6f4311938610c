#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/shared/types.h"
#include "core/shared/view_ray.h"
#include "core/trace/device_info.h"
#include "core/trace/seen_glass.h"

namespace sightline {

/// Says what rays hit in the scene that it holds: what pictures, measurements and cross-checks need. Not
/// thread-safe. All throw Error.
class Tracer {
 public:
  virtual ~Tracer() = default;
  virtual DeviceInfo info() const = 0;

  /// Nearest hits of any rays, on what ends them: glass does not, nor holes of masks, nor backs of what has
  /// only a front. hits.size() == rays.size().
  virtual void traceRays(std::span<const Ray> rays, std::span<Hit> hits) = 0;

  /// Whether the scene has glass: whether traceGlass may give anything.
  virtual bool hasGlass() const = 0;

  /// The glass that each ray meets no farther away than its hit (hits: as of traceRays): ascending by ray and
  /// triangle, each once. Empty where the scene has no glass.
  virtual std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) = 0;

  /// Square images of triangle ids (kNoTriangle where a pixel shows nothing; what ends the pixel's ray): view
  /// after view, row after row from the top. resolution: 1 .. kMaxViewResolution pixels a side;
  /// triangles.size() == views.size() * resolution^2. Rays are made on the device, so many views a call are
  /// the fastest way to see much.
  virtual void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                          std::span<uint32_t> triangles) = 0;
};

inline constexpr uint32_t kMaxViewResolution = 16384;

/// Views of one launch of traceViews: as many as make up so many pixels, which bounds the buffers.
inline size_t viewsALaunch(uint32_t resolution) {
  constexpr uint64_t kPixels = 1u << 24;
  return std::max<uint64_t>(1, kPixels / (uint64_t(resolution) * resolution));
}

}  // namespace sightline
