// Rays that are aimed at what sets lack, and what borders on what they hold: both ways.
#include "core/strip/aimed_rays.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/device/registry/make_device.h"
#include "core/place/outside_cells.h"
#include "tests/support/boxes.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

/// A core in a shell with a slit in one side, and specks: one before the shell, one behind the slit, one in
/// the core. glass: the shell is.
struct ShellWithSpecks {
  Scene scene;
  Bvh bvh;
  uint32_t core = 0, before = 0, behind_slit = 0, inside = 0;

  explicit ShellWithSpecks(bool glass) {
    testing_support::SceneOfBoxes boxes;
    boxes.addRectangle({0, 0, 0}, {0, 9, 0}, {0, 0, 9});
    boxes.addRectangle({9, 0, 0}, {0, 9, 0}, {0, 0, 9});
    boxes.addRectangle({0, 0, 0}, {9, 0, 0}, {0, 0, 9});
    boxes.addRectangle({0, 9, 0}, {9, 0, 0}, {0, 0, 9});
    boxes.addRectangle({0, 0, 0}, {9, 0, 0}, {0, 9, 0});
    boxes.addRectangle({0, 0, 9}, {4.4f, 0, 0}, {0, 9, 0});
    core = boxes.addRectangle({4.6f, 0, 9}, {4.4f, 0, 0}, {0, 9, 0}) + 2;
    boxes.addBox({3, 3, 2}, {6, 6, 5});
    before = boxes.addTriangle({2, 2, 9.01f}, {2.0001f, 2, 9.01f}, {2, 2.0001f, 9.01f});
    behind_slit = boxes.addTriangle({4.5f, 5, 8.9f}, {4.5001f, 5, 8.9f}, {4.5f, 5.0001f, 8.9f});
    inside = boxes.addTriangle({4, 4, 4}, {4.0001f, 4, 4}, {4, 4.0001f, 4});
    scene = boxes.finish();
    if (glass) {
      scene.surfaces.words.assign(scene.triangleCount(), 0u);
      std::fill_n(scene.surfaces.words.begin(), core, kSurfaceGlass);
    }
    bvh = buildBvh(scene.positions, scene.triangles);
  }

  /// What `each` rays at each triangle of all sides find that no other has found.
  std::vector<bool> aimed(const char* name, uint32_t each) const {
    const auto device = makeDevice(name, scene, bvh);
    std::vector<bool> seen(scene.triangleCount(), false);
    uint32_t index = 0;
    for (const ViewCell& cell : outsideCells(sceneBounds(scene))) {
      const auto before_cell = uint64_t(std::ranges::count(seen, true));
      const uint64_t found =
          markAimed({scene, *device}, cell, {.cell_index = index++, .seed = 1, .each = each}, seen, seen);
      EXPECT_EQ(found, uint64_t(std::ranges::count(seen, true)) - before_cell);
    }
    return seen;
  }
};

TEST(AimedRays, FindSpecksThatRandomRaysMissAndNothingHidden) {
  const ShellWithSpecks shell(false);
  const auto device = makeDevice("cpu", shell.scene, shell.bvh);
  std::vector<bool> random(shell.scene.triangleCount(), false);
  uint32_t index = 0;
  for (const ViewCell& cell : outsideCells(sceneBounds(shell.scene))) {
    markSeen({shell.scene, *device}, cell, index++, 1, 20'000, random);
  }
  EXPECT_FALSE(random[shell.before] || random[shell.behind_slit]);
  const std::vector<bool> seen = shell.aimed("cpu", 200);
  for (uint32_t id = 0; id < shell.core; ++id) EXPECT_TRUE(seen[id]) << id;
  EXPECT_TRUE(seen[shell.before]);
  EXPECT_TRUE(seen[shell.behind_slit]);
  EXPECT_FALSE(seen[shell.inside]);
  for (const uint32_t side : {0u, 2u, 8u}) {  // the core's that no place in the slit is before: -x, +x, -z
    EXPECT_FALSE(seen[shell.core + side] || seen[shell.core + side + 1]) << side;
  }
  EXPECT_TRUE(seen[shell.core + 10] && seen[shell.core + 11]);
  EXPECT_EQ(shell.aimed("opencl", 200), seen);
}

TEST(AimedRays, GoOnThroughGlass) {
  const ShellWithSpecks shell(true);
  const std::vector<bool> seen = shell.aimed("cpu", 100);
  for (uint32_t id = 0; id < seen.size(); ++id) EXPECT_EQ(seen[id], id != shell.inside) << id;
}

TEST(AimedRays, OfACellLeaveItsSurfaceAndMeetWhatItSees) {
  const ShellWithSpecks shell(false);
  const auto device = makeDevice("cpu", shell.scene, shell.bvh);
  std::vector<bool> seen(shell.scene.triangleCount(), false);
  const ViewCell cell{"inside", {1.5, 4, 4}, {0.1, 0.2, 0.3}, {0, 30, 0}};
  const std::vector<bool> none = seen;
  const uint64_t found = markAimed({shell.scene, *device}, cell, {.seed = 1, .each = 400}, none, seen);
  EXPECT_EQ(found, uint64_t(std::ranges::count(seen, true)));
  for (uint32_t id = 0; id < shell.core; ++id)
    EXPECT_EQ(seen[id], id / 2 != 1) << id;               // the core hides one wall
  EXPECT_TRUE(seen[shell.core] && seen[shell.core + 1]);  // its side towards the cell
  EXPECT_FALSE(seen[shell.core + 2] || seen[shell.core + 3] || seen[shell.inside] || seen[shell.before]);
  EXPECT_TRUE(seen[shell.behind_slit]);
}

TEST(Neighbours, ShareAnEdgeByWhereItsEndsAre) {
  testing_support::Random random(3);
  Scene scene;
  for (int i = 0; i < 400; ++i) {
    testing_support::addTriangle(scene, random.lattice(2), random.lattice(2), random.lattice(2));
  }
  scene.objects = {{"all", 0, scene.triangleCount()}};
  for (const uint32_t of : {3u, 40u}) {
    std::vector<bool> seen(scene.triangleCount());
    for (size_t i = 0; i < seen.size(); ++i) seen[i] = random.pick(of) == 0;
    std::vector<bool> expected = seen;
    for (uint32_t a = 0; a < seen.size(); ++a) {
      for (uint32_t b = 0; b < seen.size(); ++b) {
        if (!seen[b]) continue;
        const auto s = scene.corners(a), t = scene.corners(b);
        for (int i = 0; i < 9; ++i) {
          const auto &p = s[i / 3], &q = s[(i / 3 + 1) % 3], &v = t[i % 3], &w = t[(i % 3 + 1) % 3];
          if ((p == v && q == w) || (p == w && q == v)) expected[a] = true;
        }
      }
    }
    const auto before = uint64_t(std::ranges::count(seen, true));
    EXPECT_EQ(withNeighbours(scene, seen), expected);
    EXPECT_GT(uint64_t(std::ranges::count(expected, true)), before + 5);
    EXPECT_LT(uint64_t(std::ranges::count(expected, true)), seen.size());
  }
}

}  // namespace
}  // namespace sightline
