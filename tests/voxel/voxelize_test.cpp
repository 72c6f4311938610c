#include "core/voxel/voxelize.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/voxel/bin_triangles.h"

namespace sightline {
namespace {

using Place = std::array<int, 3>;

// Triangles of a few voxels to several blocks, at a voxel of 0.25.
Scene randomScene(uint64_t seed, int triangles) {
  std::mt19937_64 random(seed);
  const auto number = [&](double reach) { return float((double(random() >> 11) * 0x1p-52 - 1) * reach); };
  Scene scene;
  for (int i = 0; i < triangles; ++i) {
    const float size = i % 20 == 0 ? 30.f : 1.f;
    glm::vec3 middle(0);
    for (int axis = 0; axis < 3; ++axis) middle[axis] = number(20);
    for (int corner = 0; corner < 3; ++corner) {
      glm::vec3 step(0);
      for (int axis = 0; axis < 3; ++axis) step[axis] = number(size);
      scene.positions.push_back(middle + step);
    }
    const auto first = uint32_t(3 * i);
    scene.triangles.emplace_back(first, first + 1, first + 2);
  }
  scene.objects.push_back({"all", 0, uint32_t(triangles)});
  return scene;
}

// Of the grid, and in the same pass that blocks and bricks are in order, none empty.
std::set<Place> placesOf(const VoxelGrid& grid) {
  std::set<Place> places;
  for (size_t i = 0; i < grid.blocks.size(); ++i) {
    const VoxelBlock& block = grid.blocks[i];
    EXPECT_TRUE(i == 0 || placeBefore(grid.blocks[i - 1].place, block.place));
    EXPECT_FALSE(block.bricks.empty());
    for (size_t k = 0; k < block.bricks.size(); ++k) {
      const VoxelBrick& brick = block.bricks[k];
      EXPECT_TRUE(k == 0 || block.bricks[k - 1].place < brick.place);
      EXPECT_GT(brick.count(), 0u);
      const glm::ivec3 low =
          64 * block.place + 8 * glm::ivec3(brick.place & 7, (brick.place >> 3) & 7, brick.place >> 6);
      for (int z = 0; z < 8; ++z) {
        for (int y = 0; y < 8; ++y) {
          for (int x = 0; x < 8; ++x) {
            if (brick.contains(x, y, z)) places.insert({low.x + x, low.y + y, low.z + z});
          }
        }
      }
    }
  }
  return places;
}

// Right: a voxel is in the grid if one of the triangles meets it, and a block's list holds those that meet
// one of its voxels.
TEST(Voxelize, IsTheUnionOfTheTriangles) {
  const Scene scene = randomScene(1, 400);
  const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(0.25)});
  std::set<Place> expected;
  std::map<Place, std::set<uint32_t>> blocks;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    TriangleRows rows(inVoxels(scene.corners(id), 4));
    rows.visit({glm::ivec3(-100000), glm::ivec3(100000)}, [&](int y, int z, int first, int last) {
      for (int x = first; x <= last; ++x) {
        expected.insert({x, y, z});
        blocks[{x >> 6, y >> 6, z >> 6}].insert(id);
      }
    });
  }
  EXPECT_EQ(placesOf(grid), expected);
  EXPECT_EQ(grid.count(), expected.size());
  ASSERT_EQ(grid.blocks.size(), blocks.size());
  for (const VoxelBlock& block : grid.blocks) {
    const std::set<uint32_t>& ids = blocks.at({block.place.x, block.place.y, block.place.z});
    EXPECT_EQ(block.triangles, std::vector<uint32_t>(ids.begin(), ids.end()));
  }
  const VoxelLookup lookup(grid);
  std::mt19937_64 random(9);
  for (int i = 0; i < 20000; ++i) {
    const Place p{int(random() % 300) - 150, int(random() % 300) - 150, int(random() % 300) - 150};
    ASSERT_EQ(lookup.contains({p[0], p[1], p[2]}), expected.contains(p));
  }
}

TEST(Voxelize, IsTheSameOnAnyThreadsAndMemory) {
  const Scene scene = randomScene(2, 3000);
  const VoxelizeOptions options{.lattice = latticeOf(0.125)};
  const VoxelGrid grid = voxelize(scene, options);
  EXPECT_GT(grid.blocks.size(), 100u);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    VoxelizeOptions small = options;
    small.memory = threads;  // a layer of blocks at a time
    EXPECT_EQ(voxelize(scene, small).blocks, grid.blocks) << threads;
  }
}

TEST(Voxelize, TellsProgressAndStops) {
  const Scene scene = randomScene(3, 1000);
  VoxelizeOptions options{.lattice = latticeOf(0.25), .memory = 1};
  double last = 0;
  uint64_t voxels = 0;
  options.progress = [&](double done, uint64_t so_far) {
    EXPECT_GE(done, last);
    last = done;
    voxels = so_far;
  };
  EXPECT_EQ(voxelize(scene, options).count(), voxels);
  EXPECT_DOUBLE_EQ(last, 1);
  const std::atomic<bool> stop{true};
  options.stop = &stop;
  EXPECT_THROW(voxelize(scene, options), Interrupted);
}

std::string messageOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(Lattice, RefusesSizesThatAreNoPowersOfTwoAndTooSmall) {
  EXPECT_EQ(latticeOf(0.25).exponent, -2);
  EXPECT_EQ(latticeOf(4).exponent, 2);
  EXPECT_EQ(messageOf([] { latticeOf(0.3); }), "a voxel of 0.3 is not a power of two: take 0.25 or 0.5");
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-40}) {
    EXPECT_NE(messageOf([&] { latticeOf(bad); }).find("too small or too large"), std::string::npos) << bad;
  }
  EXPECT_EQ(messageOf([] {
              requireFits(latticeOf(0x1p-10), {glm::vec3(0), glm::vec3(100)});
            }),
            "voxels of 0.0009765625 are too small for this scene, which may hold 65536 of them along an axis "
            "and reach "
            "67108864 from the origin: take 0.001953125 or more");
  EXPECT_EQ(latticeFor({glm::vec3(0), glm::vec3(100)}, 512).exponent, -2);
  EXPECT_EQ(latticeFor({glm::vec3(0), glm::vec3(128)}, 512).exponent, -2);
}

}  // namespace
}  // namespace sightline
