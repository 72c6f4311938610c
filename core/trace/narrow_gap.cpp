#include "core/trace/narrow_gap.h"

#include <cmath>

namespace sightline {
namespace {

/// cos and sin of k * 22.5 degrees: half a circle of directions across a ray.
constexpr double kCos[] = {1,
                           0.92387953251128674,
                           0.70710678118654752,
                           0.38268343236508977,
                           0,
                           -0.38268343236508977,
                           -0.70710678118654752,
                           -0.92387953251128674};
constexpr double kSin[] = {0,
                           0.38268343236508977,
                           0.70710678118654752,
                           0.92387953251128674,
                           1,
                           0.92387953251128674,
                           0.70710678118654752,
                           0.38268343236508977};
constexpr double kReach = 1.0195911582083184;  ///< 1 / cos 11.25 degrees
constexpr double kDepth = 4;

glm::dvec3 direction(const Ray& ray) {
  return {ray.direction.x, ray.direction.y, ray.direction.z};
}

/// The ray moved across itself by `distance` along the k-th direction.
Ray neighbour(const Ray& ray, size_t k, double distance) {
  const glm::dvec3 d = direction(ray);
  const glm::dvec3 size = glm::abs(d);
  const glm::dvec3 least = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                           : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(glm::cross(d, least));
  const glm::dvec3 v = glm::normalize(glm::cross(d, u));
  const glm::dvec3 move = (u * kCos[k] + v * kSin[k]) * distance;
  Ray moved = ray;
  for (int axis = 0; axis < 3; ++axis) moved.origin[axis] = float(double(ray.origin[axis]) + move[axis]);
  return moved;
}

vec3 placeOf(const Ray& ray, float t) {
  return vec3(ray.origin) + vec3(ray.direction) * t;
}

}  // namespace

uint64_t findPinched(Tracer& tracer, float width, std::span<const Ray> rays, std::span<const Hit> hits,
                     std::vector<Pinch>& pinches) {
  pinches.assign(rays.size(), {});
  std::vector<uint32_t> left;  // not pinched yet
  for (uint32_t i = 0; i < rays.size(); ++i) {
    if (hits[i].triangle != kNoTriangle) left.push_back(i);
  }
  const auto blocks = [&](uint32_t i, const Hit& hit) {
    const double depth = kDepth * width / glm::length(direction(rays[i]));
    return hit.triangle != kNoTriangle && double(hit.t) < double(hits[i].t) - depth;
  };
  uint64_t traced = 0;
  std::vector<Ray> one, other;
  std::vector<Hit> one_hits, other_hits;
  const double reach = kReach * width;
  for (size_t k = 0; k < std::size(kCos) && !left.empty(); ++k) {
    one.clear();
    for (const uint32_t i : left) one.push_back(neighbour(rays[i], k, reach));
    one_hits.resize(one.size());
    tracer.traceRays(one, one_hits);
    std::vector<size_t> blocked;  // places in `left`
    other.clear();
    for (size_t n = 0; n < left.size(); ++n) {
      if (!blocks(left[n], one_hits[n])) continue;
      blocked.push_back(n);
      other.push_back(neighbour(rays[left[n]], k, -reach));
    }
    other_hits.resize(other.size());
    tracer.traceRays(other, other_hits);
    traced += one.size() + other.size();
    for (size_t b = 0; b < blocked.size(); ++b) {
      const size_t n = blocked[b];
      const uint32_t i = left[n];
      if (!blocks(i, other_hits[b])) continue;
      pinches[i] = {true, one_hits[n].t <= other_hits[b].t ? one_hits[n] : other_hits[b],
                    (placeOf(one[n], one_hits[n].t) + placeOf(other[b], other_hits[b].t)) * 0.5f};
    }
    std::erase_if(left, [&](uint32_t i) { return pinches[i].pinched; });
  }
  return traced;
}

}  // namespace sightline
