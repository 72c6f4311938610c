#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "core/trace/tracer.h"

namespace sightline {

/// All that rays see: what ends them, and the glass that they meet before that. Keeps its room from batch to
/// batch. One thread traces; then any read.
class Sights {
 public:
  /// Traces the rays on a device. Throws Error.
  void trace(Tracer& tracer, std::span<const Ray> rays) {
    hits_.resize(rays.size());
    tracer.traceRays(rays, hits_);
    glass_ = tracer.hasGlass() ? tracer.traceGlass(rays, hits_) : std::vector<SeenThrough>();
  }

  /// What ends each ray.
  std::span<const Hit> hits() const { return hits_; }

  /// The glass that a ray sees, ascending by triangle.
  std::span<const SeenThrough> glass(size_t ray) const {
    if (glass_.empty()) return {};
    const auto first = std::ranges::lower_bound(glass_, uint32_t(ray), {}, &SeenThrough::ray);
    auto last = first;
    while (last != glass_.end() && last->ray == ray) ++last;
    return {first, last};
  }

  /// Its triangles alone.
  std::vector<uint32_t> glassIds(size_t ray) const {
    std::vector<uint32_t> ids;
    for (const SeenThrough& seen : glass(ray)) ids.push_back(seen.triangle);
    return ids;
  }

  /// Calls see(triangle) for each triangle that a ray sees, once; what ends it is the last.
  template <typename See>
  void visit(size_t ray, See&& see) const {
    for (const SeenThrough& seen : glass(ray)) see(seen.triangle);
    if (hits_[ray].triangle != kNoTriangle) see(hits_[ray].triangle);
  }

 private:
  std::vector<Hit> hits_;
  std::vector<SeenThrough> glass_;
};

}  // namespace sightline
