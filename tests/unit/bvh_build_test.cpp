#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "bvh/bvh.h"

namespace sightline {
namespace {

struct Soup {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;

  void add(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const uint32_t n = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.emplace_back(n, n + 1, n + 2);
  }
};

Soup randomSoup(uint32_t n, uint32_t seed, float size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1, 1);
  const auto point = [&] { return glm::vec3(place(random), place(random), place(random)); };
  Soup soup;
  for (uint32_t i = 0; i < n; ++i) {
    const glm::vec3 p = point();
    soup.add(p, p + size * point(), p + size * point());
  }
  return soup;
}

TEST(BvhBuild, RandomSoupsAreValid) {
  for (const uint32_t n : {1u, 2u, 3u, 4u, 5u, 8u, 9u, 100u, 1000u, 5000u, 100000u}) {
    const Soup soup = randomSoup(n, n, 0.05f);
    const Bvh bvh = buildBvh(soup.positions, soup.triangles);
    EXPECT_EQ(validate(bvh, soup.positions, soup.triangles), "") << n;
  }
}

}  // namespace
}  // namespace sightline
