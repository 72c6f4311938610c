#pragma once
// Random triangles and rays for tests: the same from the same seed everywhere.
#include <fmt/format.h>

#include <random>
#include <string>

#include "core/scene/scene.h"
#include "core/shared/types.h"

namespace sightline::testing_support {

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  uint32_t pick(uint32_t n) { return uint32_t(engine_() % n); }
  float unit() { return float(engine_() >> 8) * 0x1p-24f; }
  vec3 point(float scale) {
    const float x = unit(), y = unit(), z = unit();
    return (vec3(x, y, z) * 2.0f - 1.0f) * scale;
  }
  /// Whole numbers from -n to n: rays and triangles that meet exactly at corners and edges.
  vec3 lattice(uint32_t n) {
    const float x = float(pick(2 * n + 1)), y = float(pick(2 * n + 1)), z = float(pick(2 * n + 1));
    return vec3(x, y, z) - float(n);
  }

 private:
  std::mt19937 engine_;
};

inline void addTriangle(Scene& scene, vec3 a, vec3 b, vec3 c) {
  const uint32_t first = uint32_t(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  scene.triangles.push_back({first, first + 1, first + 2});
}

/// Triangles near the origin; sliver: their width, as a share of their size.
inline Scene soup(Random& random, int count, float size, float sliver) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const vec3 a = random.point(1), b = a + random.point(size);
    const vec3 off = random.point(size * sliver);
    addTriangle(scene, a, b, glm::mix(a, b, random.unit()) + off);
  }
  return scene;
}

/// Hexadecimal, to paste into a test.
inline std::string describeRay(const Ray& ray) {
  const vec4 o = ray.origin, d = ray.direction;
  return fmt::format("from {:a} {:a} {:a} along {:a} {:a} {:a}", o.x, o.y, o.z, d.x, d.y, d.z);
}

}  // namespace sightline::testing_support
