#include "core/voxel/floor.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/picture/floor_picture.h"
#include "core/place/floor_cells.h"
#include "core/place/place_cells.h"
#include "core/scene/contained.h"
#include "core/scene/scene_tree.h"
#include "core/voxel/reach.h"
#include "core/voxel/voxelize.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

using testing_support::SceneOfBoxes;

struct FloorBox {
  glm::vec3 low, high;
};

// Solid boxes, where one walks, and how.
struct FloorCase {
  std::string name;
  std::vector<FloorBox> boxes;
  std::vector<glm::dvec3> seeds;
  double least_share;  // of the floor that must be covered
  FloorCellOptions options;

  Scene scene() const {
    SceneOfBoxes scene;
    for (const FloorBox& box : boxes) scene.addBox(box.low, box.high);
    return scene.finish();
  }
  bool isSolid(const glm::dvec3& place) const {
    for (const FloorBox& box : boxes) {
      if (glm::all(glm::greaterThan(place, glm::dvec3(box.low))) &&
          glm::all(glm::lessThan(place, glm::dvec3(box.high)))) {
        return true;
      }
    }
    return false;
  }
  // How far below the place the next box lies.
  double heightOver(const glm::dvec3& place) const {
    double height = HUGE_VAL;
    for (const FloorBox& box : boxes) {
      if (place.x < double(box.low.x) || place.x > double(box.high.x) || place.z < double(box.low.z) ||
          place.z > double(box.high.z) || double(box.high.y) > place.y) {
        continue;
      }
      height = std::min(height, place.y - double(box.high.y));
    }
    return height;
  }
};

// Walls around x, z from 0 to those ends, floor at 0, ceiling at 3.
std::vector<FloorBox> shell(float x, float z) {
  return {{{-0.2f, -0.2f, -0.2f}, {x + 0.2f, 0, z + 0.2f}},
          {{-0.2f, 3, -0.2f}, {x + 0.2f, 3.2f, z + 0.2f}},
          {{-0.2f, 0, -0.2f}, {0, 3, z + 0.2f}},
          {{x, 0, -0.2f}, {x + 0.2f, 3, z + 0.2f}},
          {{0, 0, -0.2f}, {x, 3, 0}},
          {{0, 0, z}, {x, 3, z + 0.2f}}};
}

std::vector<FloorCase> floorCases() {
  std::vector<FloorCase> cases;
  FloorCase pillar{"pillar", shell(8.1f, 8.1f), {{1, 1, 1}}, 0.9, {}};
  pillar.boxes.push_back({{3.7f, 0, 3.6f}, {4.4f, 3, 4.5f}});
  pillar.boxes.push_back({{6.1f, 0, 1.2f}, {7.3f, 0.75f, 2.1f}});  // a table: nobody walks on it
  cases.push_back(pillar);
  FloorCase door{"door", shell(9, 5), {{1, 1, 1}}, 0.9, {}};
  door.boxes.push_back({{4.4f, 0, 0}, {4.6f, 3, 2}});
  door.boxes.push_back({{4.4f, 0, 3}, {4.6f, 3, 5}});
  door.boxes.push_back({{4.4f, 2.1f, 2}, {4.6f, 3, 3}});
  cases.push_back(door);
  FloorCase shut = door;  // what lies behind is not reached
  shut.name = "shut door";
  shut.boxes.push_back({{4.45f, 0, 2}, {4.55f, 2.1f, 3}});
  cases.push_back(shut);
  FloorCase stairs{"stairs", {}, {{1, 1, 1}}, 0.85, {}};
  stairs.boxes = {{{0, -1, 0}, {4, 0, 3}}};
  for (int i = 0; i < 8; ++i) {
    stairs.boxes.push_back({{4 + 0.5f * float(i), -1, 0}, {4.5f + 0.5f * float(i), 0.25f * float(i + 1), 3}});
  }
  stairs.boxes.push_back({{8, 1.8f, 0}, {12, 2, 3}});  // under which one does not stand
  cases.push_back(stairs);
  FloorCase hole{"hole", {}, {{1, 1, 1}}, 0.9, {}};
  hole.boxes = {{{0, -0.2f, 0}, {8, 0, 3}},
                {{0, -0.2f, 5}, {8, 0, 8}},
                {{0, -0.2f, 3}, {3, 0, 5}},
                {{5, -0.2f, 3}, {8, 0, 5}},
                {{2, -2.2f, 2}, {6, -2, 6}}};  // its ground is too deep to step to
  cases.push_back(hole);
  return cases;
}

struct FloorOfCase {
  Scene scene;
  VoxelGrid grid;
  std::optional<VoxelSpace> space;
  Floor floor;
};

// Of the parts below the seeds.
void findFloorOf(const FloorCase& of, const Lattice& lattice, FloorOfCase& found) {
  found.scene = of.scene();
  found.grid = voxelize(found.scene, {.lattice = lattice});
  found.space.emplace(reach(found.grid, {.seeds = of.seeds}));
  const Floor all = findFloor(*found.space, floorOptions(lattice, of.options));
  std::vector<bool> keep(all.part_sizes.size(), false);
  for (const glm::dvec3& seed : of.seeds) {
    const uint32_t tile = tileBelow(all, *found.space, voxelAt(lattice, seed));
    ASSERT_NE(tile, FloorTile::kNoTile) << of.name;
    keep[all.tiles[tile].part] = true;
  }
  found.floor = tilesOf(all, [&](uint32_t tile) { return keep[all.tiles[tile].part]; });
  ASSERT_EQ(found.floor.part_sizes.size(), of.seeds.size());
}

using TilePlace = std::array<int, 3>;

bool hasEdge(const VoxelSpace& space, const glm::ivec3& tile, const FloorOptions& options) {
  for (int z = tile.z - 1; z <= tile.z + 1; ++z) {
    for (int x = tile.x - 1; x <= tile.x + 1; ++x) {
      bool is_free = x != tile.x || z != tile.z;
      for (int y = tile.y - options.step - 1; y < tile.y + options.head; ++y) {
        is_free = is_free && space.state({x, y, z}) == VoxelState::kFree;
      }
      if (is_free) return true;
    }
  }
  return false;
}

// Right: a tile is a free voxel over a voxel with a triangle, with free ones up to head, and not at an edge.
TEST(FindFloor, FindsAllTilesAndNoOther) {
  std::mt19937_64 random(3);
  for (int run = 0; run < 6; ++run) {
    VoxelGrid grid;
    for (int i = 0; i < 4; ++i) {
      BlockBits bits;
      for (int k = 0; k < 40000 * (run + 1); ++k) {
        const uint64_t number = random();
        bits.row(int(number & 63), int((number >> 6) & 63)) |= uint64_t{1} << ((number >> 12) & 63);
      }
      grid.blocks.push_back({{-(i & 1), -1, i >> 1}, bits.bricks(), {}, {}, {}});
    }
    std::ranges::sort(grid.blocks,
                      [](const VoxelBlock& a, const VoxelBlock& b) { return placeBefore(a.place, b.place); });
    const FloorOptions options{.head = 4, .step = 2};
    const VoxelSpace space = run % 2 == 0 ? VoxelSpace(grid) : reach(grid, {.from_outside = true});
    const Floor floor = findFloor(space, options);
    std::set<TilePlace> expected;
    for (int z = -1; z <= 128; ++z) {
      for (int x = -65; x <= 64; ++x) {
        int free = 0;
        for (int y = 10; y >= -66; --y) {
          const VoxelState state = space.state({x, y, z});
          const bool is_tile = state == VoxelState::kSurface && free >= options.head;
          if (is_tile && !hasEdge(space, {x, y + 1, z}, options)) expected.insert({z, x, y + 1});
          free = state == VoxelState::kFree ? free + 1 : 0;
        }
      }
    }
    ASSERT_GT(expected.size(), 300u);
    std::set<TilePlace> found;
    for (const FloorTile& tile : floor.tiles) {
      ASSERT_TRUE(found.empty() || *found.rbegin() < (TilePlace{tile.z, tile.x, tile.y}));  // in order
      found.insert({tile.z, tile.x, tile.y});
      int y = tile.y;
      while (y < 10 && space.state({tile.x, y, tile.z}) == VoxelState::kFree) ++y;
      ASSERT_TRUE(y == tile.ceiling || (y == 10 && tile.ceiling > 10));
    }
    EXPECT_EQ(found, expected);
    // Neighbours, and parts as what they join.
    std::vector<uint32_t> part(floor.tiles.size());
    for (uint32_t i = 0; i < floor.tiles.size(); ++i) {
      const FloorTile& tile = floor.tiles[i];
      for (const bool along_x : {true, false}) {
        uint32_t next = FloorTile::kNoTile;
        for (uint32_t k = 0; k < floor.tiles.size(); ++k) {
          const FloorTile& other = floor.tiles[k];
          if (other.x != tile.x + along_x || other.z != tile.z + !along_x) continue;
          if (std::abs(other.y - tile.y) > options.step) continue;
          if (std::min(other.ceiling, tile.ceiling) - std::max(other.y, tile.y) < options.head) continue;
          ASSERT_EQ(next, FloorTile::kNoTile);
          next = k;
        }
        ASSERT_EQ(along_x ? tile.next_x : tile.next_z, next);
        if (next != FloorTile::kNoTile) {
          ASSERT_EQ(floor.tiles[next].part, tile.part);
        }
      }
      if (i > 400) break;  // each looks at all
    }
  }
}

// Whether some patch of `least` by `least` tiles that no cell covers could have been one more cell.
bool leavesRoom(const Floor& floor, const std::vector<bool>& is_covered, int least, int step, int eye) {
  for (uint32_t corner = 0; corner < floor.tiles.size(); ++corner) {
    int low = INT32_MAX, high = INT32_MIN, ceiling = INT32_MAX, count = 0;
    uint32_t first = corner;
    for (int z = 0; z < least && first != FloorTile::kNoTile; ++z, first = floor.tiles[first].next_z) {
      uint32_t tile = first;
      for (int x = 0; x < least && tile != FloorTile::kNoTile && !is_covered[tile]; ++x) {
        low = std::min(low, floor.tiles[tile].y);
        high = std::max(high, floor.tiles[tile].y);
        ceiling = std::min(ceiling, floor.tiles[tile].ceiling);
        tile = floor.tiles[tile].next_x;
        ++count;
      }
    }
    if (count == least * least && high - low <= step && ceiling - high > eye) return true;
  }
  return false;
}

// Right: boxes that hold no triangle, nothing solid, and no place that is not over the floor, that are as
// large and small as allowed; and so many that no other fits.
TEST(FloorCells, StandOnTheFloorAndCoverIt) {
  const Lattice lattice = latticeOf(0.125);
  const double voxel = lattice.voxelSize();
  for (const FloorCase& of : floorCases()) {
    SCOPED_TRACE(of.name);
    FloorOfCase found;
    findFloorOf(of, lattice, found);
    const Bvh bvh = buildSceneTree(found.scene);
    const FloorCells result = floorCells(found.scene, bvh, lattice, found.floor, of.options);
    ASSERT_FALSE(result.cells.empty());
    const double margin = 0.005;  // a hundredth of the least size
    for (const ViewCell& cell : result.cells) {
      EXPECT_TRUE(containedTriangles(found.scene, bvh, cell).empty()) << cell.name;
      const glm::dvec3 low = cell.center - cell.size * 0.5, high = cell.center + cell.size * 0.5;
      for (const int axis : {0, 2}) {
        EXPECT_LE(cell.size[axis], of.options.largest);
        EXPECT_GE(cell.size[axis], of.options.least - 4 * margin);
      }
      EXPECT_GE(cell.size.y, of.options.eye - 2 * margin);
      EXPECT_LE(cell.size.y, of.options.head + voxel);
      for (int i = 0; i < 9 * 9 * 9; ++i) {
        const glm::dvec3 place = low + (high - low) * (glm::dvec3(i % 9, i / 9 % 9, i / 81) / 8.0);
        ASSERT_FALSE(of.isSolid(place)) << cell.name;
        const double height = of.heightOver({place.x, low.y, place.z});
        // A voxel that a step's front is in counts as the step.
        ASSERT_LE(height, of.options.eye / 2 + of.options.step + voxel + margin)
            << cell.name << ' ' << place.x << ' ' << place.z;
      }
    }
    std::vector<bool> is_covered(found.floor.tiles.size(), false);
    uint64_t covered = 0;
    for (size_t i = 0; i < is_covered.size(); ++i) {
      const FloorTile& tile = found.floor.tiles[i];
      const glm::dvec3 eye((tile.x + 0.5) * voxel, tile.y * voxel + of.options.eye, (tile.z + 0.5) * voxel);
      ASSERT_FALSE(of.isSolid(eye));
      for (const ViewCell& cell : result.cells) {
        if (glm::all(glm::lessThanEqual(glm::abs(eye - cell.center), cell.size * 0.5))) is_covered[i] = true;
      }
      covered += is_covered[i];
    }
    EXPECT_EQ(result.covered, covered);
    EXPECT_EQ(result.floor.tiles.size(), found.floor.tiles.size());
    EXPECT_GT(double(covered), of.least_share * double(result.floor.tiles.size()));
    EXPECT_FALSE(leavesRoom(found.floor, is_covered, 4, 6, 12));
  }
}

// The floor of the rooms, in tiles: all of it but what a voxel at a wall hides, and nothing beside it.
TEST(FloorCells, CountTheFloorThatIsReached) {
  const Lattice lattice = latticeOf(0.125);
  const auto areaOf = [&](const std::string& name) {
    for (const FloorCase& of : floorCases()) {
      if (of.name != name) continue;
      FloorOfCase found;
      findFloorOf(of, lattice, found);
      return double(found.floor.tiles.size()) * lattice.voxelSize() * lattice.voxelSize();
    }
    return 0.0;
  };
  EXPECT_NEAR(areaOf("pillar"), 8.1 * 8.1 - 0.7 * 0.9 - 1.2 * 0.9, 0.125 * (32.4 + 3.2 + 4.2 + 1));
  EXPECT_NEAR(areaOf("door"), 9 * 5 - 0.2 * 4, 0.125 * (28 + 8 + 1));
  EXPECT_NEAR(areaOf("shut door"), 4.4 * 5, 0.125 * (18.8 + 1));
  EXPECT_NEAR(areaOf("stairs"), 12 * 3, 0.125 * (30 + 1));
  EXPECT_NEAR(areaOf("hole"), 8 * 8 - 2 * 2, 0.125 * (32 + 8 + 1));
}

TEST(FloorCells, AreTheSameOnAnyThreads) {
  const Lattice lattice = latticeOf(0.125);
  const FloorCase of = floorCases()[0];
  FloorOfCase found;
  findFloorOf(of, lattice, found);
  const Bvh bvh = buildSceneTree(found.scene);
  const FloorCells cells = floorCells(found.scene, bvh, lattice, found.floor, of.options);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FloorOfCase again;
    findFloorOf(of, lattice, again);
    EXPECT_EQ(floorCells(again.scene, bvh, lattice, again.floor, of.options).cells, cells.cells) << threads;
  }
  const std::atomic<bool> stop{true};
  FloorCellOptions stopped = of.options;
  stopped.stop = &stop;
  EXPECT_THROW(floorCells(found.scene, bvh, lattice, found.floor, stopped), Interrupted);
}

// Right: a tile is green or red by whether it is covered, but for outlines; and there is nothing over the
// hole.
TEST(FloorPicture, ShowsWhatIsCovered) {
  const Lattice lattice = latticeOf(0.125);
  for (const FloorCase& of : floorCases()) {
    if (of.name != "hole") continue;
    FloorOfCase found;
    findFloorOf(of, lattice, found);
    FloorCellOptions options = of.options;
    options.least = 2;  // leaves some
    const FloorCells cells =
        floorCells(found.scene, buildSceneTree(found.scene), lattice, found.floor, options);
    const Image image = floorPicture(lattice, cells.floor, cells.is_covered, cells.cells, 4096);
    const Image bare = floorPicture(lattice, cells.floor, cells.is_covered, {}, 4096);
    int min_x = INT32_MAX, min_z = INT32_MAX;
    for (const FloorTile& tile : cells.floor.tiles) {
      min_x = std::min(min_x, tile.x);
      min_z = std::min(min_z, tile.z);
    }
    int outlined = 0, red = 0;
    for (size_t i = 0; i < cells.floor.tiles.size(); ++i) {
      const FloorTile& tile = cells.floor.tiles[i];
      const auto x = uint32_t(8 * (tile.x - min_x + 2) + 4), y = uint32_t(8 * (tile.z - min_z + 2) + 4);
      const Rgb color = bare.at(x, y);
      EXPECT_EQ(color.green > color.red, cells.is_covered[i] != 0);
      outlined += image.at(x, y) != color;
      red += color.red > color.green;
    }
    EXPECT_EQ(red, int(cells.floor.tiles.size() - cells.covered));
    EXPECT_GT(red, 0);
    EXPECT_EQ(outlined, 0);  // outlines run between tiles
    EXPECT_NE(image.pixels, bare.pixels);
    const auto hole_x = uint32_t(8 * (32 - min_x + 2)), hole_y = uint32_t(8 * (32 - min_z + 2));
    EXPECT_EQ(image.at(hole_x, hole_y), image.at(0, 0));
  }
}

TEST(FloorCells, LeaveOutSolidsByFacesWhereNothingIsReached) {
  const Lattice lattice = latticeOf(0.125);
  // Ground, and a closed box on it as large as a house: one could stand in it, and on it.
  SceneOfBoxes boxes;
  boxes.addBox({0, -1, 0}, {12, 0, 12});
  boxes.addBox({4, 0, 4}, {8, 3, 8});
  const Scene scene = boxes.finish();
  const Bvh bvh = buildSceneTree(scene);
  const VoxelGrid grid = voxelize(scene, {.lattice = lattice});
  const VoxelSpace space(grid);
  FloorCellOptions options;
  const Floor floor = findFloor(space, floorOptions(lattice, options));
  const FloorCells all = floorCells(scene, bvh, lattice, floor, options);
  options.free_side = FreeSide::kFront;
  const FloorCells outside = floorCells(scene, bvh, lattice, floor, options);
  EXPECT_EQ(all.in_solid, 0u);
  EXPECT_EQ(outside.in_solid + outside.cells.size(), all.cells.size());
  EXPECT_GT(outside.in_solid, 0u);
  EXPECT_LT(outside.floor.tiles.size(), all.floor.tiles.size());
  for (const ViewCell& cell : outside.cells) {
    EXPECT_FALSE(
        glm::all(glm::lessThan(glm::abs(cell.center - glm::dvec3(6, 1.5, 6)), glm::dvec3(2, 1.5, 2))));
  }
}

std::string floorRefusal(double FloorCellOptions::*length, double value) {
  FloorCellOptions options;
  options.*length = value;
  try {
    floorOptions(latticeOf(0.125), options);
  } catch (const Error& error) {
    EXPECT_EQ(error.exitCode(), kExitUsage);
    return error.what();
  }
  return "nothing was thrown";
}

TEST(FloorCells, RefuseLengthsOutOfRange) {
  using Options = FloorCellOptions;
  EXPECT_EQ(floorRefusal(&Options::least, 0.5), "nothing was thrown");
  EXPECT_EQ(floorRefusal(&Options::least, 0.1),
            "cells on the floor: the least size (0.1) and the eye's height (1.6) must be a voxel (0.125) or "
            "more");
  EXPECT_EQ(floorRefusal(&Options::largest, 0.4),
            "cells on the floor: the largest size (0.4) must hold the least (0.5) in whole voxels of 0.125");
  EXPECT_EQ(floorRefusal(&Options::head, 1.5),
            "cells on the floor: the head's height (1.5) must be the eye's (1.6) or more");
  EXPECT_EQ(
      floorRefusal(&Options::step, 1),
      "cells on the floor: a step (1) must be at most half of the head's height (1.8), and less than the "
      "eye's (1.6)");
  for (const double bad : {std::nan(""), HUGE_VAL, -1.0}) {
    EXPECT_EQ(floorRefusal(&Options::largest, bad),
              "cells on the floor: lengths must be finite numbers, and not negative");
  }
}

// Right: boxes of the grid without a triangle, of a room that the seed's joins with. Two rooms with a wall
// between them, faces turned any way.
TEST(GridCells, AreReachedThroughDoorsOnly) {
  for (const bool is_open : {true, false}) {
    FloorCase of = floorCases()[is_open ? 1 : 2];
    Scene scene = of.scene();
    for (size_t i = 0; i < scene.triangles.size(); i += 3)
      std::swap(scene.triangles[i].x, scene.triangles[i].y);
    const Bvh bvh = buildSceneTree(scene);
    const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(0.125)});
    const VoxelSpace space = reach(grid, {.seeds = of.seeds});
    GridOptions options;
    options.size = glm::dvec3(0.7);
    options.free_side = FreeSide::kAny;
    const std::vector<ViewCell> all = gridCells(scene, bvh, options);
    options.space = &space;
    GridCounts counts;
    const std::vector<ViewCell> reached = gridCells(scene, bvh, options, &counts);
    std::vector<ViewCell> expected;
    for (const ViewCell& cell : all) {
      const glm::dvec3 c = cell.center;
      const bool is_inside = c.x > 0 && c.y > 0 && c.z > 0 && c.x < 9 && c.y < 3 && c.z < 5;
      if (is_inside && (is_open || c.x < 4.5)) expected.push_back(cell);
    }
    EXPECT_EQ(reached, expected);
    EXPECT_EQ(counts.not_reached, all.size() - expected.size());
    EXPECT_EQ(counts.kept, expected.size());
    EXPECT_GT(expected.size(), 50u);
  }
}

}  // namespace
}  // namespace sightline
