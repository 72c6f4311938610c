// Scenes whose potentially visible set is known by construction, on every device.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::bakeOn;
using testing_support::idRange;
using testing_support::quickParams;
using testing_support::SceneOfBoxes;

class Golden : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (std::string(GetParam()) == "vulkan") {
      SL_SKIP_WITHOUT_VULKAN();
    }
  }
  std::vector<uint32_t> visible(const Scene& scene, const ViewCell& cell) {
    const CellPvs pvs = bakeOn(GetParam(), scene, cell);
    EXPECT_EQ(pvs.stats.missing_rays, 0u);
    return pvs.triangles;
  }
};

/// What stands outside a closed room is never seen, however large; the room is seen whole.
TEST_P(Golden, ClosedRoom) {
  SceneOfBoxes boxes;
  const uint32_t room = boxes.addBox({-5, 0, -5}, {5, 3, 5});
  boxes.addBox({-50, -1, 6}, {50, 40, 7});
  boxes.addBox({5.001f, 0, -5}, {6, 3, 5});
  const Scene scene = boxes.finish();
  EXPECT_EQ(visible(scene, {"cell", {0, 1.5, 0}, {1, 1, 1}}), idRange(room, 12));
}

/// Two rooms with a door between: the cell sees the wall opposite the door and what stands in its view, but
/// not the pillar beside the door in the other room.
TEST_P(Golden, TwoRoomsAndADoor) {
  SceneOfBoxes boxes;
  boxes.addRectangle({0, 0, -10}, {0, 10, 0}, {0, 0, 9});  // wall x = 0, the door is -1 < z < 1
  boxes.addRectangle({0, 0, 1}, {0, 10, 0}, {0, 0, 9});
  boxes.addRectangle({0, 3, -1}, {0, 7, 0}, {0, 0, 2});
  const uint32_t opposite = boxes.addRectangle({10, 0, -10}, {0, 10, 0}, {0, 0, 20});
  const uint32_t in_view = boxes.addRectangle({5, 0.5f, -0.2f}, {0, 0.5f, 0}, {0, 0, 0.4f});
  const uint32_t hidden = boxes.addRectangle({0.5f, 0, 5}, {0, 2, 0}, {0, 0, 1});
  boxes.addRectangle({-10, 0, -10}, {20, 0, 0}, {0, 0, 20});   // floor
  boxes.addRectangle({-10, 10, -10}, {20, 0, 0}, {0, 0, 20});  // ceiling
  const Scene scene = boxes.finish();
  const std::vector<uint32_t> set = visible(scene, {"cell", {-3, 1, 0}, {1, 1, 1}});
  const auto has = [&](uint32_t id) { return std::binary_search(set.begin(), set.end(), id); };
  EXPECT_TRUE(has(opposite) && has(opposite + 1));
  EXPECT_TRUE(has(in_view) && has(in_view + 1));
  EXPECT_FALSE(has(hidden) || has(hidden + 1));
}

/// A slit of a thousandth of the wall's width shows the targets behind it to a cell wide enough; targets
/// that no line through slit and cell reaches stay hidden.
TEST_P(Golden, Slit) {
  SceneOfBoxes boxes;
  boxes.addRectangle({-10, -10, 0}, {9.995f, 0, 0}, {0, 20, 0});
  boxes.addRectangle({0.005f, -10, 0}, {9.995f, 0, 0}, {0, 20, 0});
  std::vector<uint32_t> targets;
  for (int i = -4; i <= 4; ++i) {
    targets.push_back(boxes.addRectangle({float(i) - 0.25f, -0.25f, -5}, {0.5f, 0, 0}, {0, 0.5f, 0}));
  }
  const Scene scene = boxes.finish();
  // The cell's points x in [-1, 1] at z = 5 look through x = 0 to x in [-1, 1] at z = -5.
  const std::vector<uint32_t> set = visible(scene, {"cell", {0, 0, 5}, {2, 2, 0}, {0, 180, 0}});
  for (int i = -4; i <= 4; ++i) {
    const bool expected = std::abs(i) <= 1;
    for (uint32_t t = 0; t < 2; ++t) {
      EXPECT_EQ(std::binary_search(set.begin(), set.end(), targets[i + 4] + t), expected) << "target " << i;
    }
  }
}

/// A wall of cubes: the cell in front sees every front face and, of the others, those that face an axis of
/// view; backs are hidden by the cubes themselves.
TEST_P(Golden, GridOfCubes) {
  SceneOfBoxes boxes;
  std::vector<uint32_t> cubes;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) {
      cubes.push_back(boxes.addBox({float(x) * 2, float(y) * 2, 0}, {float(x) * 2 + 1, float(y) * 2 + 1, 1}));
    }
  }
  const Scene scene = boxes.finish();
  const std::vector<uint32_t> set = visible(scene, {"cell", {5.5, 5.5, 20}, {30, 30, 0}, {0, 180, 0}});
  const auto has = [&](uint32_t id) { return std::binary_search(set.begin(), set.end(), id); };
  // A driver's ray tracing may lose a ray that passes right through an edge; it then sees a cube's back.
  const bool watertight = std::string(GetParam()) != "vulkan";
  for (const uint32_t cube : cubes) {
    EXPECT_TRUE(has(cube + 10) && has(cube + 11)) << "front of cube at " << cube;
    if (watertight) {
      EXPECT_FALSE(has(cube + 8) || has(cube + 9)) << "back of cube at " << cube;
    }
    for (uint32_t side = 0; side < 8; ++side)
      EXPECT_TRUE(has(cube + side)) << "side " << side << " of " << cube;
  }
}

/// Triangles have two sides: the one that only shows its back is in the set.
TEST_P(Golden, TriangleSeenFromTheBack) {
  for (const bool flipped : {false, true}) {
    SceneOfBoxes boxes;
    const glm::vec3 a(-1, -1, -5), b(1, -1, -5), c(0, 1, -5);
    boxes.addTriangle(a, flipped ? c : b, flipped ? b : c);
    EXPECT_EQ(visible(boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 0}, {0, 180, 0}}), idRange(0, 1));
  }
}

/// A flat cell sees nothing behind it; its normal is local +z.
TEST_P(Golden, FlatCellLooksAlongItsNormalOnly) {
  SceneOfBoxes boxes;
  const uint32_t front = boxes.addRectangle({-1, -1, 5}, {2, 0, 0}, {0, 2, 0});
  boxes.addRectangle({-1, -1, -5}, {2, 0, 0}, {0, 2, 0});
  EXPECT_EQ(visible(boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 0}}), idRange(front, 2));
}

/// A box sees to all six sides.
TEST_P(Golden, BoxLooksToAllSides) {
  SceneOfBoxes boxes;
  boxes.addBox({-9, -9, -9}, {9, 9, 9});
  EXPECT_EQ(visible(boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 1}, {10, 20, 30}}), idRange(0, 12));
}

/// A triangle inside the cell is seen from within, though no ray from the cell's faces outwards meets it.
TEST_P(Golden, ContainedTriangleIsInTheSet) {
  SceneOfBoxes boxes;
  boxes.addTriangle({-0.1f, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0});
  boxes.addBox({-9, -9, -9}, {9, 9, 9});
  const Scene scene = boxes.finish();
  const CellPvs pvs = bakeOn(GetParam(), scene, {"cell", {0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(pvs.triangles, idRange(0, 13));
  EXPECT_EQ(pvs.stats.contained_triangles, 1u);
  EXPECT_EQ(pvs.witnesses[0].stage, kStageContained);
}

/// A triangle that meets the cell and that rays find is explored like any other: its neighbours, of which few
/// random rays hit one, are found along its border.
TEST_P(Golden, ExplorationAlsoStartsFromTrianglesInTheCell) {
  SceneOfBoxes boxes;
  boxes.addRectangle({-50, 0, -50}, {100, 0, 0}, {0, 0, 100});  // a floor through the cell
  for (int i = 0; i < 50; ++i) boxes.addRectangle({float(i) - 25, 0, 50}, {0.5f, 0, 0}, {0, 0.001f, 0});
  BakeParams params = quickParams();
  params.n_rand = 1000;
  params.n_abs_edge = 400;
  const CellPvs pvs = bakeOn(GetParam(), boxes.finish(), {"cell", {0, 0.4, 0}, {1, 1, 1}}, params);
  EXPECT_GT(pvs.triangles.size(), 20u);
}

/// Border and reverse sampling find what random rays cannot: with one random ray, the whole room is explored.
TEST_P(Golden, ExplorationAloneFindsTheNeighbours) {
  SceneOfBoxes boxes;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) boxes.addRectangle({float(x) - 5, float(y) - 5, 0}, {1, 0, 0}, {0, 1, 0});
  }
  const Scene scene = boxes.finish();
  BakeParams params = quickParams();
  params.n_rand = 64;
  params.max_rays = 1'000'000'000;
  const CellPvs pvs = bakeOn(GetParam(), scene, {"cell", {0, 0, 5}, {1, 1, 0}, {0, 180, 0}}, params);
  EXPECT_EQ(pvs.triangles, idRange(0, 200));
  EXPECT_GT(pvs.stats.border.new_triangles, 100u);
}

/// Nothing to see: an empty set, not an endless loop.
TEST_P(Golden, CellThatSeesNothing) {
  SceneOfBoxes boxes;
  boxes.addBox({-1, -1, -10}, {1, 1, -8});
  EXPECT_TRUE(visible(boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 0}}).empty());
}

INSTANTIATE_TEST_SUITE_P(Devices, Golden, testing::Values("cpu", "opencl", "vulkan"),
                         [](const auto& device) { return std::string(device.param); });

}  // namespace
}  // namespace sightline
