// The scan: closed, faces outwards, never meets itself; with holes, open at their rims alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/formats/load_scene.h"
#include "core/formats/save_scene.h"
#include "core/generate/generate.h"
#include "core/generate/scan_surface.h"
#include "tests/scene/edge_counts.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::errorOf;

class GeneratedScan : public testing::TestWithParam<std::tuple<uint64_t, uint64_t>> {};

TEST_P(GeneratedScan, IsOneClosedSurface) {
  const auto [n, seed] = GetParam();
  const Scene scene = generateScene("scan", n, seed);
  const test::EdgeCounts edges = test::countEdges(scene.triangles);
  EXPECT_EQ(edges.open, 0u);
  EXPECT_EQ(edges.other, 0u);
  EXPECT_EQ(edges.paired, 3 * scene.triangles.size());
  EXPECT_EQ(scene.positions.size(), scene.triangles.size() / 2 + 2) << "of Euler: a sphere";
  const std::vector<double> volumes = test::volumesOfPieces(scene.triangles, scene.positions);
  ASSERT_EQ(volumes.size(), 1u);
  EXPECT_GT(volumes[0] / 6, 10) << "cubic metres of a statue and its plinth";
  EXPECT_LT(volumes[0] / 6, 40);
}

/// A ray from outside enters and leaves by turns: it is never inside twice, which it would be where the
/// surface meets itself.
TEST_P(GeneratedScan, DoesNotMeetItself) {
  const auto [n, seed] = GetParam();
  const Scene scene = generateScene("scan", n, seed);
  for (int ray = 0; ray < 64; ++ray) {
    const double y = 0.013 + 5.7 * (ray + 0.37) / 64, z = 0.7 * ((ray * 37) % 64 / 64.0 - 0.5) + 0.00123;
    std::vector<std::pair<double, int>> crossings;
    for (const glm::uvec3& t : scene.triangles) {
      // Along x: the triangle in the plane of y and z.
      double sides[3];
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a = scene.positions[t[k]], b = scene.positions[t[(k + 1) % 3]];
        sides[k] = (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
      }
      const bool left = sides[0] > 0 && sides[1] > 0 && sides[2] > 0,
                 right = sides[0] < 0 && sides[1] < 0 && sides[2] < 0;
      if (!left && !right) continue;
      const double sum = sides[0] + sides[1] + sides[2];
      const double x =
          (sides[1] * double(scene.positions[t.x].x) + sides[2] * double(scene.positions[t.y].x) +
           sides[0] * double(scene.positions[t.z].x)) /
          sum;
      crossings.emplace_back(x, left ? -1 : 1);  // left: faces +x, so that a ray along +x leaves
    }
    std::ranges::sort(crossings);
    int inside = 0;
    for (const auto& [x, step] : crossings) {
      inside += step;
      ASSERT_TRUE(inside == 0 || inside == 1) << "y " << y << " z " << z << " x " << x;
    }
    ASSERT_EQ(inside, 0);
  }
}

TEST_P(GeneratedScan, HolesAreOpenEdges) {
  const auto [n, seed] = GetParam();
  const Scene whole = generateScene("scan", n, seed), scene = generateScene("scan", n, seed, {.holes = true});
  EXPECT_EQ(scene.positions, whole.positions);
  EXPECT_LT(scene.triangles.size(), whole.triangles.size());
  EXPECT_GT(double(scene.triangles.size()), 0.94 * double(whole.triangles.size()));
  const test::EdgeCounts edges = test::countEdges(scene.triangles);
  EXPECT_GT(edges.open, 0u);
  EXPECT_EQ(edges.other, 0u);
  // What is left is of the whole, and rims run into themselves: as many edges come as go at each vertex.
  std::set<std::array<uint32_t, 3>> all;
  for (const glm::uvec3& t : whole.triangles) all.insert({t.x, t.y, t.z});
  std::set<std::pair<uint32_t, uint32_t>> directed;
  for (const glm::uvec3& t : scene.triangles) {
    ASSERT_TRUE(all.contains({t.x, t.y, t.z}));
    for (int k = 0; k < 3; ++k) directed.insert({t[k], t[(k + 1) % 3]});
  }
  std::map<uint32_t, int> balance;
  for (const auto& [from, to] : directed) {
    if (directed.contains({to, from})) continue;
    ++balance[from];
    --balance[to];
  }
  for (const auto& [vertex, sum] : balance) ASSERT_EQ(sum, 0) << vertex;
}

INSTANTIATE_TEST_SUITE_P(Sizes, GeneratedScan,
                         testing::Combine(testing::Values(1'000ull, 5'555ull, 20'000ull, 300'000ull),
                                          testing::Values(1ull, 2ull, 0xffffffffffffffffull)),
                         [](const auto& c) {
                           return std::to_string(std::get<0>(c.param)) + "_" +
                                  std::to_string(std::get<1>(c.param));
                         });

TEST(ScanScene, IsTheSameFromEveryCompiler) {
  EXPECT_EQ(hashScene(generateScene("scan", 300'000, 1, {.holes = true})), 2901333236127052580u);
}

TEST(ScanScene, StreamsTheSameFile) {
  const test::Folder folder;
  for (const bool holes : {false, true}) {
    const SceneExtras extras{.holes = holes};
    const Scene scene = generateScene("scan", 1'300'000, 5, extras);
    saveScene(scene, folder / "a.glb");
    saveGlb(streamScan(1'300'000, 5, extras), folder / "b.glb");
    EXPECT_TRUE(test::readText(folder / "a.glb") == test::readText(folder / "b.glb"));
    EXPECT_EQ(hashScene(loadScene(folder / "b.glb")), hashScene(scene));
  }
}

TEST(ScanScene, MoreTrianglesThanOtherScenes) {
  EXPECT_EQ(errorOf([] { generateScene("scan", kMaxScanTriangles + 1, 1); }),
            "triangle count 200000001 is out of range 1000..200000000 of the scene 'scan'");
  EXPECT_EQ(errorOf([] { generateScene("city", 20'000, 1, {.holes = true}); }),
            "the scene 'city' has no holes of a scanner: scan has");
  const ScanSurface surface(kMaxScanTriangles, 1, false);
  uint64_t triangles = 0;
  for (const ScanSurface::Panel& panel : surface.panels()) {
    const glm::uvec2 quads = panel.end - panel.first;
    triangles += 2 * uint64_t(quads.x) * quads.y;
  }
  EXPECT_LE(triangles, kMaxScanTriangles);
  EXPECT_GT(double(triangles), 0.99 * double(kMaxScanTriangles));
}

/// Finer, it is the same statue: the fewer triangles' vertices lie near the more's surface.
TEST(ScanScene, IsOfOneSize) {
  for (const uint64_t n : {10'000ull, 100'000ull, 1'000'000ull}) {
    const Bounds bounds = sceneBounds(generateScene("scan", n, 4));
    EXPECT_NEAR(bounds.high.y, 5.75, 0.2);
    EXPECT_NEAR(bounds.low.y, 0, 0.1);
    EXPECT_NEAR(bounds.high.x, 2.03, 0.1);
    EXPECT_NEAR(bounds.low.z, -2.03, 0.1);
  }
}

}  // namespace
}  // namespace sightline
