#pragma once
// What rays see, by all triangles in double: through glass, to what ends them.
#include <cmath>
#include <set>
#include <vector>

#include "core/scene/scene.h"
#include "core/shared/types.h"

namespace sightline::testing_support {

struct BruteSight {
  bool sure = true;  ///< far from all edges, and nothing is equally near
  uint32_t end = kNoTriangle;
  std::vector<uint32_t> glass;  ///< ascending

  std::set<uint32_t> all() const {
    std::set<uint32_t> ids(glass.begin(), glass.end());
    if (end != kNoTriangle) ids.insert(end);
    return ids;
  }
};

/// Of a scene without masks and culled backs.
inline BruteSight bruteSight(const Scene& scene, const Ray& ray) {
  BruteSight sight;
  double nearest = HUGE_VAL;
  std::vector<std::pair<uint32_t, double>> glass;
  const glm::dvec3 o(ray.origin), d(ray.direction);
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    const auto corners = scene.corners(id);
    const glm::dvec3 a = glm::dvec3(corners[0]) - o, b = glm::dvec3(corners[1]) - o,
                     c = glm::dvec3(corners[2]) - o;
    const double u = glm::dot(d, glm::cross(b, c)), v = glm::dot(d, glm::cross(c, a)),
                 w = glm::dot(d, glm::cross(a, b)), det = u + v + w;
    if (det == 0) continue;
    const double least = std::min({u / det, v / det, w / det});
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double t = glm::dot(a, normal) / glm::dot(d, normal);
    if (std::fabs(least) < 1e-5 && t > -1e-5) sight.sure = false;
    if (least < 0 || !(t > 0)) continue;
    if ((scene.surfaces.of(id) & kSurfaceGlass) != 0) {
      glass.emplace_back(id, t);
    } else {
      if (std::fabs(t - nearest) < 1e-5 * t) sight.sure = false;
      if (t < nearest) nearest = t, sight.end = id;
    }
  }
  for (const auto& [id, t] : glass) {
    if (std::fabs(t - nearest) < 1e-5 * t) sight.sure = false;
    if (t <= nearest) sight.glass.push_back(id);
  }
  return sight;
}

}  // namespace sightline::testing_support
