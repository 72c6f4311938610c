#include "core/gvs/find_leaks.h"

#include <algorithm>
#include <chrono>

#include "core/base/splitmix.h"
#include "core/cell/cell_frame.h"
#include "core/shared/triangle.h"
#include "core/trace/narrow_gap.h"

namespace sightline {
namespace {

/// Triangles that are looked at together.
constexpr size_t kChunk = 1u << 18;
constexpr uint32_t kTries = 16;

Ray rayOf(const glm::vec3& origin, const glm::vec3& direction) {
  return {vec4(origin, 0), vec4(direction, 0)};
}

/// A triangle whose witness is pinched.
struct Suspect {
  uint32_t triangle;
  glm::vec3 origin;  ///< of the witness
  vec3 place;
};

/// Numbers 0 .. 1 that depend on triangle and try alone.
class TryRandom {
 public:
  TryRandom(uint32_t triangle, uint32_t attempt)
      : state_(mixBits(uint64_t(triangle) << 32 | (attempt + 1))) {}
  double unit() { return double(mixBits(state_ += kSplitmixStep) >> 11) * 0x1p-53; }

 private:
  uint64_t state_;
};

class LeakSearch {
 public:
  LeakSearch(Tracer& tracer, const Scene& scene, const CellPvs& pvs, float width)
      : tracer_(tracer), scene_(scene), pvs_(pvs), frame_(cellFrame(pvs.cell)) {
    leaks_.width = width;
  }

  Leaks run() {
    for (size_t first = 0; first < pvs_.triangles.size(); first += kChunk) {
      std::vector<Suspect> suspects = pinchedFrom(first);
      for (uint32_t attempt = 0; attempt < kTries && !suspects.empty(); ++attempt) acquit(suspects, attempt);
      if (leaks_.triangles == 0 && !suspects.empty()) {
        leaks_.first_triangle = suspects.front().triangle;
        leaks_.place = glm::dvec3(suspects.front().place);
      }
      leaks_.triangles += suspects.size();
    }
    return leaks_;
  }

 private:
  /// targets: the triangle that each ray is aimed at. Where that is glass that the ray meets, it is the hit.
  void trace(const std::vector<Ray>& rays, const std::vector<uint32_t>& targets) {
    hits_.resize(rays.size());
    tracer_.traceRays(rays, hits_);
    if (tracer_.hasGlass()) {
      for (const SeenThrough& seen : tracer_.traceGlass(rays, hits_)) {
        if (seen.triangle != targets[seen.ray]) continue;
        const auto corners = scene_.corners(seen.triangle);
        hits_[seen.ray] = {intersectTriangle(shearRay(rays[seen.ray]), corners[0], corners[1], corners[2]),
                           seen.triangle};
      }
    }
    leaks_.rays += rays.size() + findPinched(tracer_, scene_, leaks_.width, rays, hits_, pinches_);
  }

  std::vector<Suspect> pinchedFrom(size_t first) {
    std::vector<Ray> rays;
    std::vector<size_t> of;
    std::vector<uint32_t> targets;
    for (size_t i = first; i < std::min(first + kChunk, pvs_.triangles.size()); ++i) {
      const Witness& witness = pvs_.witnesses[i];
      if (witness.stage == kStageContained) continue;
      rays.push_back(rayOf(witness.origin, witness.direction));
      of.push_back(i);
      targets.push_back(pvs_.triangles[i]);
    }
    trace(rays, targets);
    std::vector<Suspect> suspects;
    for (size_t k = 0; k < rays.size(); ++k) {
      const uint32_t id = pvs_.triangles[of[k]];
      if (hits_[k].triangle == id && pinches_[k].pinched) {
        suspects.push_back({id, pvs_.witnesses[of[k]].origin, pinches_[k].place});
      }
    }
    return suspects;
  }

  /// Drops those that another ray sees with room on its way.
  void acquit(std::vector<Suspect>& suspects, uint32_t attempt) {
    std::vector<Ray> rays;
    std::vector<uint32_t> targets;
    for (const Suspect& suspect : suspects) {
      rays.push_back(tryOf(suspect, attempt));
      targets.push_back(suspect.triangle);
    }
    trace(rays, targets);
    size_t i = 0;
    std::erase_if(suspects, [&](const Suspect& suspect) {
      const size_t k = i++;
      return hits_[k].triangle == suspect.triangle && !pinches_[k].pinched;
    });
  }

  /// From anywhere on the cell, or from nearer and nearer to where the witness begins, to anywhere on the
  /// triangle. Without direction where a flat cell does not look there.
  Ray tryOf(const Suspect& suspect, uint32_t attempt) const {
    TryRandom random(suspect.triangle, attempt);
    glm::dvec3 local;
    for (int axis = 0; axis < 3; ++axis) local[axis] = (2 * random.unit() - 1) * frame_.half_size[axis];
    if (attempt % 2 == 1) {
      const double scale = 1.0 / double(1u << (attempt / 2 + 1));
      local = glm::clamp(frame_.toLocal(glm::dvec3(suspect.origin)) + local * scale, -frame_.half_size,
                         frame_.half_size);
    }
    const glm::vec3 origin(frame_.toWorld(local));
    double u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto corners = scene_.corners(suspect.triangle);
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    const glm::vec3 direction(a + (b - a) * u + (c - a) * v - glm::dvec3(origin));
    const bool looks = !pvs_.cell.flat() || glm::dot(frame_.axes[2], glm::dvec3(direction)) > 0;
    return rayOf(origin, looks ? direction : glm::vec3(0));
  }

  Tracer& tracer_;
  const Scene& scene_;
  const CellPvs& pvs_;
  CellFrame frame_;
  Leaks leaks_;
  std::vector<Hit> hits_;
  std::vector<Pinch> pinches_;
};

}  // namespace

float leakWidth(const ViewCell& cell) {
  return float(std::max({cell.size.x, cell.size.y, cell.size.z}) / 1000);
}

Leaks findLeaks(Tracer& tracer, const Scene& scene, const CellPvs& pvs, float width) {
  const auto start = std::chrono::steady_clock::now();
  Leaks leaks = LeakSearch(tracer, scene, pvs, width).run();
  leaks.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return leaks;
}

}  // namespace sightline
