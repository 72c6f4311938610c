// Boxes along a walk hold every frame's eye, and keep clear of triangles.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/cell/cell_contains.h"
#include "core/cell/cell_frame.h"
#include "core/cell/cell_problem.h"
#include "core/generate/generate.h"
#include "core/place/clear_box.h"
#include "core/place/place_cells.h"
#include "core/scene/scene_tree.h"
#include "tests/scene/box_overlap.h"

namespace sightline {
namespace {

/// Cells that hold a position.
size_t holders(const std::vector<ViewCell>& cells, const glm::dvec3& at) {
  return size_t(std::ranges::count_if(cells, [&](const ViewCell& cell) { return cellContains(cell, at); }));
}

class WalkCellsOf : public testing::TestWithParam<std::string> {};

TEST_P(WalkCellsOf, HoldEveryFrameAndNoTriangle) {
  const Scene scene = generateScene(GetParam(), 20'000, 1);
  const Bvh bvh = buildSceneTree(scene);
  const CameraPath path = generateWalk(GetParam(), 20'000, 1, 900);
  const PathOptions options{.width = 2.5, .height = 2, .length = 25};
  const WalkCells walk = walkCells(scene, bvh, path, options, 0.02);
  EXPECT_TRUE(walk.frames_left_out.empty()) << walk.frames_left_out.front();
  EXPECT_FALSE(cellProblem(walk.cells)) << cellProblem(walk.cells)->text();
  for (uint32_t frame = 0; frame < path.frames(); ++frame) {
    EXPECT_GT(holders(walk.cells, placeAt(path, frame).eye), 0u) << "frame " << frame;
    if (frame > 0 && !startsStretch(path, frame)) {
      const glm::dvec3 a = placeAt(path, frame - 1).eye, b = placeAt(path, frame).eye;
      EXPECT_TRUE(std::ranges::any_of(
          walk.cells, [&](const ViewCell& cell) { return cellContains(cell, a) && cellContains(cell, b); }))
          << "between frames " << frame - 1 << " and " << frame;
    }
  }
  double length = 0;
  for (uint32_t frame = 1; frame < path.frames(); ++frame) {
    if (!startsStretch(path, frame))
      length += glm::length(placeAt(path, frame).eye - placeAt(path, frame - 1).eye);
  }
  EXPECT_LT(double(walk.cells.size()), 20 + 3 * length / options.length) << "few";
  for (const ViewCell& cell : walk.cells) {
    EXPECT_LE(cell.size.x, options.width);
    EXPECT_LE(cell.size.y, options.height);
    EXPECT_LE(cell.size.z, options.length);
    EXPECT_EQ(test::firstTriangleInCell(scene, cell), kNoTriangle) << cell.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, WalkCellsOf, testing::Values("city", "canyon", "plant", "bistro"),
                         [](const auto& c) { return c.param; });

Scene wallAt(float x) {
  Scene scene;
  scene.positions = {{x, -50, -50}, {x, 50, -50}, {x, 0, 100}};
  scene.triangles = {{0, 1, 2}};
  scene.objects = {{"wall", 0, 1}};
  return scene;
}

TEST(WalkCells, ComeInForAWallAndLeaveOutWhatIsTooNear) {
  const CameraPath path = pathThrough({.points = {{0, 0, 0}, {0, 0, 20}}, .frames = 41});
  const auto cellsBy = [&](float wall, double margin) {
    const Scene scene = wallAt(wall);
    return walkCells(scene, buildSceneTree(scene), path, {.width = 2, .height = 2, .length = 100}, margin);
  };
  const WalkCells free = cellsBy(5, 0.1), near = cellsBy(0.5f, 0.1), blocked = cellsBy(0.05f, 0.1);
  ASSERT_EQ(free.cells.size(), 1u);
  EXPECT_EQ(free.inset, 0u);
  EXPECT_EQ(free.cells[0].size, glm::dvec3(2, 2, 21));
  ASSERT_EQ(near.cells.size(), 1u);
  EXPECT_EQ(near.inset, 1u);
  EXPECT_NEAR(near.cells[0].size.x, 1.4, 1e-9);
  EXPECT_TRUE(blocked.cells.empty());
  EXPECT_EQ(blocked.frames_left_out.size(), 41u);
  EXPECT_EQ(cellsBy(0.05f, 0).cells.size(), 1u);
  const Scene scene = wallAt(5);
  EXPECT_THROW(walkCells(scene, buildSceneTree(scene), path, {.width = 0}, 0), Error);
}

TEST(WalkCells, DoNotReachOverACut) {
  const CameraPath path{
      .keys = {{0, {{0, 0, 0}, {1, 0, 0}}}, {5, {{1, 0, 0}, {2, 0, 0}}}, {6, {{8, 0, 0}, {9, 0, 0}}}},
      .cuts = {6}};
  const Scene scene = wallAt(100);
  const WalkCells walk =
      walkCells(scene, buildSceneTree(scene), path, {.width = 2, .height = 2, .length = 50}, 0);
  ASSERT_EQ(walk.cells.size(), 2u);
  EXPECT_EQ(holders(walk.cells, {4, 0, 0}), 0u);
}

}  // namespace
}  // namespace sightline
