#include "core/voxel/reach.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>
#include <random>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/voxel/voxelize.h"

namespace sightline {
namespace {

// States of the voxels of a box by brute force, all that is beside it as one.
struct BruteSpace {
  VoxelBox box;
  std::vector<VoxelState> states;
  VoxelState outside = VoxelState::kInner;

  size_t indexOf(const glm::ivec3& voxel) const {
    const glm::ivec3 size = box.high - box.low + 1, at = voxel - box.low;
    return size_t(at.x + size.x * (at.y + size.y * at.z));
  }
  VoxelState at(const glm::ivec3& voxel) const {
    return holds(box, voxel) ? states[indexOf(voxel)] : outside;
  }
};

BruteSpace bruteReach(const VoxelGrid& grid, const std::vector<glm::ivec3>& seeds, bool from_outside) {
  BruteSpace space;
  space.box = boxOf(grid);
  space.box.low -= 1;  // a layer that stands for the outside
  space.box.high += 1;
  const glm::ivec3 size = space.box.high - space.box.low + 1;
  space.states.assign(size_t(size.x) * size_t(size.y) * size_t(size.z), VoxelState::kInner);
  for (const VoxelBlock& block : grid.blocks) {
    for (const VoxelBrick& brick : block.bricks) {
      const glm::ivec3 low =
          64 * block.place + 8 * glm::ivec3(brick.place & 7, (brick.place >> 3) & 7, brick.place >> 6);
      for (int i = 0; i < 512; ++i) {
        const glm::ivec3 at(i & 7, (i >> 3) & 7, i >> 6);
        if (brick.contains(at.x, at.y, at.z)) space.states[space.indexOf(low + at)] = VoxelState::kSurface;
      }
    }
  }
  std::vector<glm::ivec3> open;
  const auto visit = [&](const glm::ivec3& voxel) {
    if (!holds(space.box, voxel) || space.at(voxel) != VoxelState::kInner) return;
    space.states[space.indexOf(voxel)] = VoxelState::kFree;
    open.push_back(voxel);
  };
  for (const glm::ivec3& seed : seeds) visit(glm::clamp(seed, space.box.low, space.box.high));
  if (from_outside) visit(space.box.low);
  while (!open.empty()) {
    const glm::ivec3 voxel = open.back();
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        glm::ivec3 next = voxel;
        next[axis] += step;
        visit(next);
      }
    }
  }
  space.outside = space.at(space.box.low);
  return space;
}

// Of blocks from -1 to 1: voxels by chance.
VoxelGrid noise(uint64_t seed, double filled, const VoxelBox& box) {
  std::mt19937_64 random(seed);
  VoxelGrid grid;
  for (int z = box.low.z >> 6; z <= box.high.z >> 6; ++z) {
    for (int y = box.low.y >> 6; y <= box.high.y >> 6; ++y) {
      for (int x = box.low.x >> 6; x <= box.high.x >> 6; ++x) {
        const glm::ivec3 place(x, y, z);
        const VoxelBox part =
            overlapOf({box.low - 64 * place, box.high - 64 * place}, {glm::ivec3(0), glm::ivec3(63)});
        BlockBits bits;
        for (int k = part.low.z; k <= part.high.z; ++k) {
          for (int j = part.low.y; j <= part.high.y; ++j) {
            for (int i = part.low.x; i <= part.high.x; ++i) {
              if (double(random() >> 11) * 0x1p-53 < filled) bits.row(j, k) |= uint64_t{1} << i;
            }
          }
        }
        VoxelBlock block;
        block.place = place;
        block.bricks = bits.bricks();
        if (!block.bricks.empty()) grid.blocks.push_back(block);
      }
    }
  }
  return grid;
}

void expectEqual(const VoxelSpace& space, const BruteSpace& brute) {
  EXPECT_EQ(space.outside(), brute.outside);
  SpaceCounts counts;
  const VoxelBox tight{brute.box.low + 1, brute.box.high - 1};
  for (int z = brute.box.low.z - 1; z <= brute.box.high.z + 1; ++z) {
    for (int y = brute.box.low.y - 1; y <= brute.box.high.y + 1; ++y) {
      for (int x = brute.box.low.x - 1; x <= brute.box.high.x + 1; ++x) {
        const VoxelState state = space.state({x, y, z});
        ASSERT_EQ(int(state), int(brute.at({x, y, z}))) << x << ' ' << y << ' ' << z;
        if (!holds(tight, {x, y, z})) continue;
        ++(state == VoxelState::kFree    ? counts.free
           : state == VoxelState::kInner ? counts.inner
                                         : counts.surface);
      }
    }
  }
  EXPECT_EQ(space.counts().free, counts.free);
  EXPECT_EQ(space.counts().inner, counts.inner);
  EXPECT_EQ(space.counts().surface, counts.surface);
}

// Where so many voxels are met, what is not makes long winding ways and many pockets.
TEST(Reach, IsWhatAFloodVoxelByVoxelFinds) {
  const VoxelBox box{{-75, -40, -66}, {70, 30, 20}};
  for (const double filled : {0.02, 0.5, 0.62, 0.66}) {
    const VoxelGrid grid = noise(uint64_t(1000 * filled), filled, box);
    const VoxelLookup lookup(grid);
    expectEqual(reach(grid, {.from_outside = true}), bruteReach(grid, {}, true));
    std::mt19937_64 random(5);
    for (int run = 0; run < 4; ++run) {
      glm::ivec3 seed;
      do {
        for (int axis = 0; axis < 3; ++axis) seed[axis] = box.low[axis] + int(random() % 87);
      } while (lookup.contains(seed));
      ReachOptions options;
      options.seeds = {glm::dvec3(seed) + 0.25};
      expectEqual(reach(grid, options), bruteReach(grid, {seed}, false));
    }
  }
}

// A closed room: what is in it is reached from in it alone, and what is outside from outside.
VoxelGrid room(int side, const glm::ivec3& hole) {
  VoxelGrid grid = noise(1, 1, {glm::ivec3(0), glm::ivec3(side - 1)});
  for (VoxelBlock& block : grid.blocks) {
    BlockBits bits;
    bits.insert(block.bricks);
    for (int z = 0; z < 64; ++z) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          const glm::ivec3 at = 64 * block.place + glm::ivec3(x, y, z);
          const bool is_within = holds({glm::ivec3(1), glm::ivec3(side - 2)}, at);
          if (is_within || at == hole) bits.row(y, z) &= ~(uint64_t{1} << x);
        }
      }
    }
    block.bricks = bits.bricks();
  }
  std::erase_if(grid.blocks, [](const VoxelBlock& block) { return block.bricks.empty(); });
  return grid;
}

TEST(Reach, PassesAHoleOfOneVoxelAndNothingElse) {
  const int side = 130;  // the block in its middle holds nothing
  for (const bool is_open : {false, true}) {
    const VoxelGrid grid = room(side, is_open ? glm::ivec3(0, 90, 17) : glm::ivec3(-5));
    const std::vector<glm::ivec3> seeds{{100, 100, 100}};
    ReachOptions options{.seeds = {glm::dvec3(100.5)}};
    const VoxelSpace inside = reach(grid, options);
    expectEqual(inside, bruteReach(grid, seeds, false));
    EXPECT_EQ(inside.outside(), is_open ? VoxelState::kFree : VoxelState::kInner);
    EXPECT_EQ(inside.state(glm::ivec3(1000000)), inside.outside());
    const VoxelSpace outside = reach(grid, {.from_outside = true});
    expectEqual(outside, bruteReach(grid, {}, true));
    EXPECT_EQ(outside.state(glm::ivec3(100)), is_open ? VoxelState::kFree : VoxelState::kInner);
    EXPECT_EQ(outside.innerInBlock(glm::ivec3(1)), is_open ? Share::kNone : Share::kAll);
  }
}

TEST(Reach, KnowsTheShareOfCubes) {
  const VoxelGrid grid = noise(7, 0.3, {{-70, 3, -66}, {90, 80, 20}});
  const VoxelGrid closed = room(200, glm::ivec3(-5));
  std::mt19937_64 random(11);
  for (const VoxelGrid* of : {&grid, &closed}) {
    for (const bool from_outside : {true, false}) {
      ReachOptions options{.from_outside = from_outside};
      if (!from_outside) options.seeds = {of == &grid ? glm::dvec3(500) : glm::dvec3(64)};
      const VoxelSpace space = reach(*of, options);
      int seen[3] = {0, 0, 0};
      for (int level = 0; level <= 8; ++level) {
        for (int run = 0; run < 200; ++run) {
          glm::ivec3 low;
          for (int axis = 0; axis < 3; ++axis) low[axis] = (int(random() % 400) - 150) >> level << level;
          if (run > 2000 >> (2 * level)) break;
          bool any = false, all = true;
          for (int i = 0; i < 1 << (3 * level); ++i) {
            const int mask = (1 << level) - 1;
            const bool is_inner = space.state(low + glm::ivec3(i & mask, (i >> level) & mask,
                                                               i >> (2 * level))) == VoxelState::kInner;
            any = any || is_inner;
            all = all && is_inner;
            if (any && !all) break;
          }
          const Share expected = all ? Share::kAll : any ? Share::kSome : Share::kNone;
          ++seen[int(expected)];
          ASSERT_EQ(space.innerIn(low, level), expected) << level;
        }
      }
      EXPECT_GT(seen[0] + seen[1] + seen[2], 500);
    }
  }
}

TEST(Reach, IsTheSameOnAnyThreads) {
  const VoxelGrid grid = noise(3, 0.62, {glm::ivec3(-100), glm::ivec3(100)});
  const VoxelSpace space = reach(grid, {.from_outside = true});
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const VoxelSpace again = reach(grid, {.from_outside = true});
    EXPECT_EQ(again.counts().inner, space.counts().inner);
    for (int i = 0; i < 200000; ++i) {
      const glm::ivec3 voxel(i % 199 - 99, i / 199 % 199 - 99, i / (199 * 199) * 13 % 199 - 99);
      ASSERT_EQ(again.state(voxel), space.state(voxel));
    }
  }
}

TEST(Reach, StartsFromTheFreeVoxelsOfABox) {
  const VoxelGrid grid = room(150, glm::ivec3(-5));
  ReachOptions options;
  options.boxes = {{{-20, 20, 20}, {1, 80, 80}}};  // through the wall: on both sides of it
  const VoxelSpace space = reach(grid, options);
  EXPECT_EQ(space.counts().inner, 0u);
  EXPECT_EQ(space.outside(), VoxelState::kFree);
  options.boxes = {{{0, 20, 20}, {70, 80, 80}}};  // the wall, and inside
  EXPECT_EQ(reach(grid, options).outside(), VoxelState::kInner);
}

std::string refusalOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.exitCode(), kExitUsage);
    return error.what();
  }
  return "nothing was thrown";
}

TEST(Reach, RefusesToStartInSurfaceOrNowhere) {
  VoxelGrid grid = room(80, glm::ivec3(-5));
  grid.lattice.exponent = -1;
  ReachOptions options;
  EXPECT_EQ(refusalOf([&] { reach(grid, options); }), "free space: no place to start from");
  options.seeds = {{0.25, 10, 12}};
  EXPECT_EQ(refusalOf([&] { reach(grid, options); }),
            "the place 0.25,10,12 is in voxels of 0.5 that triangles meet: take a place farther from "
            "triangles, or smaller voxels");
  options.seeds = {};
  options.boxes = {{{0, 4, 4}, {0, 8, 8}}};
  EXPECT_EQ(refusalOf([&] { reach(grid, options); }),
            "the box from 0,2,2 to 0.5,4.5,4.5 is in voxels of 0.5 that triangles meet: take a place farther "
            "from triangles, or smaller voxels");
}

TEST(Reach, TellsProgressAndStops) {
  const VoxelGrid grid = noise(4, 0.3, {glm::ivec3(-100), glm::ivec3(100)});
  double last = 0;
  ReachOptions options{.from_outside = true};
  options.progress = [&](double done) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, 1);
    last = done;
  };
  reach(grid, options);
  EXPECT_EQ(last, 1);
  const std::atomic<bool> stop{true};
  options.stop = &stop;
  EXPECT_THROW(reach(grid, options), Interrupted);
}

TEST(Reach, OfNothingIsAllFree) {
  const VoxelGrid grid;
  const VoxelSpace space = reach(grid, {.from_outside = true});
  EXPECT_EQ(space.state({1, 2, 3}), VoxelState::kFree);
  EXPECT_EQ(space.innerIn({0, 0, 0}, 8), Share::kNone);
  EXPECT_EQ(space.counts().free, 0u);
}

}  // namespace
}  // namespace sightline
