#include <gtest/gtest.h>

#include <algorithm>

#include "core/place/place_cells.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

using testing_support::bakeOn;
using testing_support::SceneOfBoxes;

/// A level on a lattice of 2: a floor, walls and a ceiling around two rooms, and a wall without thickness
/// between them, all of it seen from within; 50 small boxes stand in the second room.
struct TwoRooms {
  Scene scene;
  uint32_t first_object = 0;  ///< triangles from here on are the boxes'
};

TwoRooms twoRooms() {
  SceneOfBoxes boxes;
  boxes.addRectangle({0, 0, 0}, {0, 0, 8}, {16, 0, 0});  // floor
  boxes.addRectangle({0, 4, 0}, {16, 0, 0}, {0, 0, 8});  // ceiling
  boxes.addRectangle({0, 0, 0}, {16, 0, 0}, {0, 4, 0});
  boxes.addRectangle({0, 0, 8}, {0, 4, 0}, {16, 0, 0});
  boxes.addRectangle({0, 0, 0}, {0, 4, 0}, {0, 0, 8});
  boxes.addRectangle({16, 0, 0}, {0, 0, 8}, {0, 4, 0});
  boxes.addRectangle({8, 0, 0}, {0, 0, 8}, {0, 4, 0});  // between the rooms
  TwoRooms rooms;
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 low(9 + 0.6f * float(i % 10), 0.25f, 1 + 1.2f * float(i / 10));
    const uint32_t id = boxes.addBox(low, low + glm::vec3(0.3f));
    if (i == 0) rooms.first_object = id;
  }
  rooms.scene = boxes.finish();
  return rooms;
}

/// How many of the objects' triangles the cells of the first room see.
size_t seenThroughTheWall(const TwoRooms& rooms, const std::vector<ViewCell>& cells) {
  size_t seen = 0;
  for (const ViewCell& cell : cells) {
    const CellPvs pvs = bakeOn("cpu", rooms.scene, cell);
    seen +=
        size_t(std::ranges::count_if(pvs.triangles, [&](uint32_t id) { return id >= rooms.first_object; }));
  }
  return seen;
}

TEST(CellsOnWalls, AGridsCellsDoNotSeeThroughTheWallsThatTheyStandAt) {
  const TwoRooms rooms = twoRooms();
  const Bvh bvh = buildBvh(rooms.scene.positions, rooms.scene.triangles);
  GridOptions options;
  options.size = {4, 4, 4};
  options.free_side = FreeSide::kAny;  // the wall between the rooms has its front on one side only
  options.count = {{2, 1, 2}};
  const std::vector<ViewCell> cells = gridCells(rooms.scene, bvh, options);
  ASSERT_EQ(cells.size(), 4u) << "all of the first room";
  EXPECT_EQ(seenThroughTheWall(rooms, cells), 0u);
  options.margin = 0;
  EXPECT_GT(seenThroughTheWall(rooms, gridCells(rooms.scene, bvh, options)), 50u) << "what the margin is for";
}

TEST(CellsOnWalls, APathsCellsDoNotSeeThroughTheWallsThatTheyCut) {
  const TwoRooms rooms = twoRooms();
  const Bvh bvh = buildBvh(rooms.scene.positions, rooms.scene.triangles);
  const glm::dvec3 points[] = {{6.9, 1.5, 1}, {6.9, 1.5, 7}};
  const std::vector<ViewCell> cells = pathCells(points, {2.5, 2, 10});  // 0.15 of its width is in the wall
  const ClearCells clear = keepClear(rooms.scene, bvh, cells, 0.02);
  ASSERT_EQ(clear.cells.size(), 1u);
  EXPECT_EQ(seenThroughTheWall(rooms, clear.cells), 0u);
  EXPECT_GT(seenThroughTheWall(rooms, cells), 50u);
}

}  // namespace
}  // namespace sightline
