#include "core/scene/in_solid.h"

#include <cmath>

namespace sightline {
namespace {

/// Based on: M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018: 2^32 over the
/// plastic number and over its square. Points of the plane that keep apart, in whole numbers.
constexpr uint32_t kStepX = 3242174889u, kStepY = 2447445414u;

/// From -1 to 1, without either and without 0.
double signedUnit(uint32_t bits) {
  return (double(bits) + 0.5) * 0x1p-31 - 1;
}

bool hitsBack(const Scene& scene, uint32_t id, const glm::vec3& direction) {
  const auto t = scene.corners(id);
  const glm::dvec3 a = t[0];
  const glm::dvec3 normal = glm::cross(glm::dvec3(t[1]) - a, glm::dvec3(t[2]) - a);
  return glm::dot(normal, glm::dvec3(direction)) > 0;
}

}  // namespace

// Based on: G. Marsaglia, Choosing a Point from the Surface of a Sphere, 1972: an even disc gives an even
// sphere by square roots alone, which every machine rounds alike; sines and cosines differ between them.
std::array<glm::vec3, kSolidProbes> solidProbes() {
  std::array<glm::vec3, kSolidProbes> directions;
  size_t count = 0;
  for (uint32_t i = 0; count < directions.size(); ++i) {
    const double x = signedUnit(i * kStepX), y = signedUnit(i * kStepY), s = x * x + y * y;
    if (s >= 1) continue;
    const double stretch = 2 * std::sqrt(1 - s);
    directions[count++] = glm::vec3(glm::dvec3(x * stretch, 1 - 2 * s, y * stretch));
  }
  return directions;
}

bool inSolid(const Scene& scene, FreeSide free_side, std::span<const glm::vec3> directions,
             std::span<const Hit> hits) {
  if (free_side == FreeSide::kAny) return false;
  size_t seen = 0, wrong = 0;
  for (size_t i = 0; i < directions.size(); ++i) {
    if (hits[i].triangle == kNoTriangle) continue;
    seen++;
    wrong += hitsBack(scene, hits[i].triangle, directions[i]) == (free_side == FreeSide::kFront) ? 1 : 0;
  }
  return 2 * wrong > seen;
}

}  // namespace sightline
