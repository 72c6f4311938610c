#include "core/scene/contained.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/cell/cell_frame.h"
#include "tests/support/make_cell.h"

namespace sightline {
namespace {

using testing_support::makeCell;

Scene makeScene(const std::vector<std::vector<glm::vec3>>& triangles) {
  Scene scene;
  for (const auto& triangle : triangles) {
    const auto first = uint32_t(scene.positions.size());
    scene.positions.insert(scene.positions.end(), triangle.begin(), triangle.end());
    scene.triangles.emplace_back(first, first + 1, first + 2);
  }
  return scene;
}

using Ids = std::vector<uint32_t>;

TEST(ContainedTriangles, BoxTakesWhatItMeets) {
  const Scene scene = makeScene({
      {{-9, 0, -9}, {9, 0, -9}, {0, 0, 9}},                       // 0: through the middle, corners outside
      {{0.1f, 0.1f, 0.1f}, {0.2f, 0.1f, 0.1f}, {0, 0.2f, 0.1f}},  // 1: inside
      {{2, 2, 2}, {3, 2, 2}, {2, 3, 2}},                          // 2: far
      {{-9, -1, -9}, {9, -1, -9}, {0, -1, 9}},                    // 3: the floor
      {{-9, -1.001f, -9}, {9, -1.001f, -9}, {0, -1.001f, 9}},     // 4: just below the floor
      {{1, 1, 1}, {2, 2, 2}, {3, 2, 2}},                          // 5: touches a corner
      {{2.9f, 0.2f, 0}, {0.2f, 2.9f, 0}, {3, 3, 0}},              // 6: its box meets, an edge passes by
      {{0, 0, 0}, {0.5f, 0, 0}, {0.25f, 0, 0}},                   // 7: no area
  });
  EXPECT_EQ(containedTriangles(scene, makeCell({0, 0, 0}, {2, 2, 2})), (Ids{0, 1, 3, 5}));
}

TEST(ContainedTriangles, FlatCellLooksForwardOnly) {
  const Scene scene = makeScene({
      {{-1, -1, -1}, {1, -1, -1}, {0, 1, 1}},            // 0: crosses the rectangle
      {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}},              // 1: in its plane
      {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0, 0, -1}},         // 2: touches it from behind
      {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0, 0, 1}},          // 3: touches it from the front
      {{-0.5f, 0, 0.01f}, {0.5f, 0, 0.01f}, {0, 0, 1}},  // 4: in front, apart
      {{-9, 0, -1}, {9, 0, -1}, {5, 0, 9}},              // 5: crosses
      {{5, 0, -1}, {9, 0, -1}, {5, 0, 9}},               // 6: crosses the plane elsewhere
  });
  EXPECT_EQ(containedTriangles(scene, makeCell({0, 0, 0}, {2, 2, 0})), (Ids{0, 3, 5}));
  EXPECT_EQ(containedTriangles(scene, makeCell({0, 0, 0}, {2, 2, 0}, {0, 180, 0})), (Ids{0, 2, 5}));
}

TEST(ContainedTriangles, WallAtARoundedFaceIsTaken) {
  // 0.3 is no float: the face lies at float(0.3), beside the exact box.
  for (const float y : {0.3f, 0.1f, -0.7f, 1000.1f}) {
    const Scene scene = makeScene({{{-9, y, -9}, {9, y, -9}, {0, y, 9}}});
    const double exact = std::round(double(y) * 10.0) / 10.0;
    EXPECT_EQ(containedTriangles(scene, makeCell({0, exact + 0.5, 0}, {1, 1, 1})), Ids{0}) << y;
    EXPECT_EQ(containedTriangles(scene, makeCell({0, exact - 0.5, 0}, {1, 1, 1})), Ids{0}) << y;
    // Facing up from it as a flat cell, the wall is in the cell's plane.
    EXPECT_EQ(containedTriangles(scene, makeCell({0, exact, 0}, {1, 1, 0}, {-90, 0, 0})), Ids{}) << y;
    EXPECT_EQ(containedTriangles(scene, makeCell({0, exact, 0}, {1, 1, 0}, {90, 0, 0})), Ids{}) << y;
  }
}

/// Whether any of many points of the triangle lies in the box: never more than the truth.
bool samplesMeet(const std::vector<glm::vec3>& t, const ViewCell& cell) {
  const CellFrame frame = cellFrame(cell);
  constexpr int kSteps = 60;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = double(i) / kSteps;
      const double v = double(j) / kSteps;
      const glm::dvec3 p = glm::dvec3(t[0]) * (1.0 - u - v) + glm::dvec3(t[1]) * u + glm::dvec3(t[2]) * v;
      const glm::dvec3 local = glm::abs(frame.toLocal(p));
      if (glm::all(glm::lessThanEqual(local, frame.half_size))) return true;
    }
  }
  return false;
}

TEST(ContainedTriangles, AgreesWithSampledPoints) {
  constexpr uint64_t kSeed = 3;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<float> coordinate(-2.0f, 2.0f);
  std::uniform_real_distribution<double> angle(-180.0, 180.0);
  int contained = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<glm::vec3> t(3);
    for (glm::vec3& corner : t) corner = {coordinate(random), coordinate(random), coordinate(random)};
    ViewCell cell = makeCell({0.1, 0.2, 0.3}, {1.0, 1.5, 0.5}, {angle(random), angle(random), angle(random)});
    const bool found = !containedTriangles(makeScene({t}), cell).empty();
    contained += found ? 1 : 0;
    const bool sampled = samplesMeet(t, cell);
    EXPECT_TRUE(found || !sampled) << "seed " << kSeed << " round " << round;
    cell.size *= 1.2;  // points are 1/60 of at most 7 units apart
    EXPECT_TRUE(!found || samplesMeet(t, cell)) << "seed " << kSeed << " round " << round;
  }
  EXPECT_GT(contained, 200);
  EXPECT_LT(contained, 1800);
}

TEST(ContainedTriangles, AscendingOverManyBlocks) {
  Scene scene = makeScene({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}}});
  const std::vector<glm::uvec3> both = scene.triangles;
  Ids expected;
  for (uint32_t i = 2; i < 200'000; ++i) scene.triangles.push_back(both[i % 7 == 0 ? 0 : 1]);
  scene.triangles[0] = both[0];
  for (uint32_t i = 0; i < 200'000; ++i) {
    if (i == 0 || (i > 1 && i % 7 == 0)) expected.push_back(i);
  }
  EXPECT_EQ(containedTriangles(scene, makeCell({0, 0, 0}, {1, 1, 1})), expected);
}

TEST(ContainedTriangles, ScaleByPowerOfTwoChangesNothing) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> coordinate(-1.0f, 1.0f);
  Scene scene;
  for (uint32_t i = 0; i < 3000; ++i) {
    scene.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    if (i % 3 == 2) scene.triangles.emplace_back(i - 2, i - 1, i);
  }
  ViewCell cell = makeCell({0.1, 0.2, 0.3}, {0.3, 0.2, 0.7}, {10, 20, 30});
  const Ids ids = containedTriangles(scene, cell);
  for (glm::vec3& p : scene.positions) p *= 1024.0f;
  cell.center *= 1024.0;
  cell.size *= 1024.0;
  EXPECT_EQ(containedTriangles(scene, cell), ids);
  EXPECT_GT(ids.size(), 10u);
}

}  // namespace
}  // namespace sightline
