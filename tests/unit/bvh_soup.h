#pragma once
// Triangle soups for the tests of the tree.
#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

namespace sightline {

struct Soup {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;

  void add(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const uint32_t n = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.emplace_back(n, n + 1, n + 2);
  }
};

/// Points in [-1, 1)^3, the same on every machine.
class RandomPoints {
 public:
  explicit RandomPoints(uint32_t seed) : random_(seed) {}
  float number() { return static_cast<float>(random_() >> 8) * 0x1p-23f - 1; }
  glm::vec3 point() {
    const float x = number(), y = number(), z = number();
    return {x, y, z};
  }

 private:
  std::mt19937 random_;
};

/// Triangles of about the given size anywhere.
inline Soup randomSoup(uint32_t n, uint32_t seed, float size) {
  RandomPoints random(seed);
  Soup soup;
  for (uint32_t i = 0; i < n; ++i) {
    const glm::vec3 p = random.point(), q = random.point(), r = random.point();
    soup.add(p, p + size * q, p + size * r);
  }
  return soup;
}

/// Long thin triangles across the whole cube, in all directions.
inline Soup sliverSoup(uint32_t n, uint32_t seed) {
  RandomPoints random(seed);
  Soup soup;
  for (uint32_t i = 0; i < n; ++i) {
    const glm::vec3 p = random.point(), q = random.point(), r = random.point();
    soup.add(p, q, q + 1e-3f * r);
  }
  return soup;
}

/// A height field of 2 * side * side triangles that share vertices.
inline Soup gridSoup(uint32_t side) {
  Soup soup;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      soup.positions.emplace_back(static_cast<float>(x), static_cast<float>((x * 7 + y * 13) % 5) * 0.1f,
                                  static_cast<float>(y));
    }
  }
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t i = y * (side + 1) + x;
      soup.triangles.emplace_back(i, i + 1, i + side + 1);
      soup.triangles.emplace_back(i + 1, i + side + 2, i + side + 1);
    }
  }
  return soup;
}

}  // namespace sightline
