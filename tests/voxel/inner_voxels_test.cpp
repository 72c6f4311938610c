// Sets made of others: what lies below a plane, and what is inner.
#include "core/voxel/inner_voxels.h"

#include <gtest/gtest.h>

#include <random>

#include "core/voxel/reach.h"
#include "core/voxel/voxels_below.h"

namespace sightline {
namespace {

/// Hollow boxes, one larger than a block, about a corner of blocks.
VoxelGrid hollowBoxes() {
  std::vector<std::pair<glm::ivec3, glm::ivec3>> boxes = {
      {{-70, -70, -70}, {70, 3, 5}}, {{10, 10, 10}, {20, 30, 25}}, {{-30, 10, 10}, {-28, 12, 12}}};
  VoxelGrid grid;
  for (int z = -2; z < 2; ++z) {
    for (int y = -2; y < 2; ++y) {
      for (int x = -2; x < 2; ++x) {
        const glm::ivec3 block(x, y, z);
        BlockBits bits;
        for (int i = 0; i < 64 * 64 * 64; ++i) {
          const glm::ivec3 at(i & 63, (i >> 6) & 63, i >> 12), voxel = 64 * block + at;
          for (const auto& [low, high] : boxes) {
            if (!holds({low, high}, voxel) || holds({low + 1, high - 1}, voxel)) continue;
            bits.row(at.y, at.z) |= uint64_t{1} << at.x;
          }
        }
        grid.blocks.emplace_back();
        grid.blocks.back().place = block;
        grid.blocks.back().bricks = bits.bricks();
        if (grid.blocks.back().bricks.empty()) grid.blocks.pop_back();
      }
    }
  }
  return grid;
}

template <typename Expected>
void expectSet(const VoxelGrid& grid, Expected&& expected) {
  const VoxelLookup lookup(grid);
  uint64_t count = 0;
  for (int z = -128; z < 128; ++z) {
    for (int y = -128; y < 128; ++y) {
      for (int x = -128; x < 128; ++x) {
        const bool is_in = expected(glm::ivec3(x, y, z));
        count += is_in ? 1 : 0;
        ASSERT_EQ(lookup.contains({x, y, z}), is_in) << x << " " << y << " " << z;
      }
    }
  }
  EXPECT_EQ(grid.count(), count);
  for (size_t i = 0; i < grid.blocks.size(); ++i) {
    EXPECT_TRUE(i == 0 || placeBefore(grid.blocks[i - 1].place, grid.blocks[i].place));
    for (const VoxelBrick& brick : grid.blocks[i].bricks) EXPECT_GT(brick.count(), 0u);
  }
}

TEST(InnerVoxels, AreThoseOfTheSpace) {
  const VoxelGrid grid = hollowBoxes();
  const VoxelSpace space = reach(grid, {.from_outside = true});
  EXPECT_GT(space.counts().inner, 100'000u);
  expectSet(innerVoxels(space), [&](const glm::ivec3& v) { return space.state(v) == VoxelState::kInner; });
}

TEST(VoxelsBelow, AreThoseBelow) {
  const VoxelGrid grid = hollowBoxes();
  const VoxelLookup lookup(grid);
  for (const int64_t end : {int64_t(-1) << 40, int64_t(-70), int64_t(-64), int64_t(-13), int64_t(0),
                            int64_t(11), int64_t(1) << 40}) {
    const VoxelGrid below = voxelsBelow(grid, end);
    EXPECT_EQ(below.lattice, grid.lattice);
    expectSet(below, [&](const glm::ivec3& v) { return v.y < end && lookup.contains(v); });
  }
}

}  // namespace
}  // namespace sightline
