#include "core/voxel/reach.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <deque>
#include <memory>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/voxel/block_flood.h"

namespace sightline {
namespace {

constexpr size_t kFloodsATime = 256;  // blocks between two looks at `stop`
constexpr uint32_t kNoSurface = ~uint32_t{0};

glm::ivec3 stepThrough(int side) {
  glm::ivec3 step(0);
  step[side / 2] = (side & 1) != 0 ? 1 : -1;
  return step;
}

BlockSide fullSide() {
  BlockSide full;
  full.fill(~uint64_t{0});
  return full;
}

// The parts of a block that no triangle meets, as far as paths may go.
void freeOf(const VoxelBlock& block, const std::optional<VoxelBox>& within, BlockBits& free) {
  free.clear();
  free.insert(block.bricks);
  for (int z = 0; z < kBlockSide; ++z) {
    for (int y = 0; y < kBlockSide; ++y) free.row(y, z) = ~free.row(y, z);
  }
  if (!within) return;
  const glm::ivec3 low = block.place * kBlockSide;
  const VoxelBox part =
      overlapOf({within->low - low, within->high - low}, {glm::ivec3(0), glm::ivec3(kBlockSide - 1)});
  for (int z = 0; z < kBlockSide; ++z) {
    for (int y = 0; y < kBlockSide; ++y) {
      const bool is_in = z >= part.low.z && z <= part.high.z && y >= part.low.y && y <= part.high.y;
      free.row(y, z) &= is_in ? rowBits(part.low.x, part.high.x) : 0;
    }
  }
}

// Blocks that a triangle meets are flooded one by one, many at once, whenever something came in through
// their sides; blocks without are reached as a whole. The order is of no effect: what is reached is the
// smallest set that holds the start and what is next to it.
class Flood {
 public:
  Flood(const VoxelGrid& grid, const ReachOptions& options)
      : grid_(grid), options_(options), box_(blocksAround(grid)), size_(box_.high - box_.low + 1) {
    surface_.assign(size_t(size_.x) * size_t(size_.y) * size_t(size_.z), kNoSurface);
    is_reached_.assign(surface_.size(), 0);
    for (size_t i = 0; i < grid.blocks.size(); ++i) surface_[indexOf(grid.blocks[i].place)] = uint32_t(i);
    mixed_.resize(grid.blocks.size());
  }

  void startAt(const VoxelBox& voxels, const std::string& what) {
    const VoxelBox blocks{voxels.low >> 6, voxels.high >> 6};
    const VoxelBox inside = overlapOf(blocks, box_);
    bool is_any = !(inside.low == blocks.low && inside.high == blocks.high);
    if (is_any) reachOutside();
    for (int z = inside.low.z; z <= inside.high.z; ++z) {
      for (int y = inside.low.y; y <= inside.high.y; ++y) {
        for (int x = inside.low.x; x <= inside.high.x; ++x) {
          is_any = startInBlock({x, y, z}, voxels) || is_any;
        }
      }
    }
    if (is_any) return;
    const std::string size = fmt::format("{:g}", grid_.lattice.voxelSize());
    throw Error(fmt::format("{} is in voxels of {} that triangles meet: take a place farther from triangles, "
                            "or smaller voxels",
                            what, size),
                kExitUsage);
  }

  void reachOutside() {
    if (is_outside_) return;
    is_outside_ = true;
    for (int side = 0; side < kSides; ++side) {
      if (!mayLeave(side)) continue;
      VoxelBox layer = box_;
      const int axis = side / 2;
      ((side & 1) != 0 ? layer.low : layer.high)[axis] = ((side & 1) != 0 ? box_.high : box_.low)[axis];
      for (int z = layer.low.z; z <= layer.high.z; ++z) {
        for (int y = layer.low.y; y <= layer.high.y; ++y) {
          for (int x = layer.low.x; x <= layer.high.x; ++x) enter({x, y, z}, side, kFull);
        }
      }
    }
  }

  void run() {
    spread();
    while (!queue_.empty()) {
      if (options_.stop != nullptr && *options_.stop) throw Interrupted();
      if (options_.progress) {
        options_.progress(double(touched_) / double(surface_.size()));
      }
      const size_t count = std::min(kFloodsATime, queue_.size());
      const std::vector<uint32_t> now(queue_.begin(), queue_.begin() + int64_t(count));
      queue_.erase(queue_.begin(), queue_.begin() + int64_t(count));
      std::vector<Passed> passed(count);
      tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1), [&](const auto& range) {
        BlockBits free, reached;
        for (size_t i = range.begin(); i < range.end(); ++i) flood(now[i], free, reached, passed[i]);
      });
      for (size_t i = 0; i < count; ++i) mixed_[now[i]].is_queued = false;
      for (size_t i = 0; i < count; ++i) {
        for (int side = 0; side < kSides; ++side) {
          if (((passed[i].sides >> side) & 1) == 0) continue;
          leave(grid_.blocks[now[i]].place, side, passed[i].bits[size_t(side)]);
        }
      }
      spread();
    }
  }

  VoxelSpace space() {
    VoxelSpace space(grid_);
    space.setOutsideInner(!is_outside_);
    for (size_t i = 0; i < surface_.size(); ++i) {
      if (surface_[i] == kNoSurface && is_reached_[i] == 0) space.setInner(placeOf(i), Share::kAll);
    }
    std::vector<PackedBlock> inner(std::min(kFloodsATime, grid_.blocks.size()));
    for (size_t begin = 0; begin < grid_.blocks.size(); begin += kFloodsATime) {
      const size_t count = std::min(kFloodsATime, grid_.blocks.size() - begin);
      tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1), [&](const auto& range) {
        BlockBits free, reached;
        for (size_t i = range.begin(); i < range.end(); ++i) {
          Mixed& mixed = mixed_[begin + i];
          freeOf(grid_.blocks[begin + i], options_.within, free);
          reached.clear();
          mixed.reached.addTo(reached);
          mixed.reached = {};
          for (int z = 0; z < kBlockSide; ++z) {
            for (int y = 0; y < kBlockSide; ++y) free.row(y, z) &= ~reached.row(y, z);
          }
          inner[i] = packBlock(free);
        }
      });
      for (size_t i = 0; i < count; ++i) {
        const bool is_any = inner[i].shareOf(glm::ivec3(0), 6) != Share::kNone;
        space.setInner(grid_.blocks[begin + i].place, is_any ? Share::kSome : Share::kNone,
                       std::move(inner[i]));
      }
    }
    if (options_.progress) options_.progress(1);
    return space;
  }

 private:
  using Sides = std::array<BlockSide, kSides>;
  // Of a block that triangles meet.
  struct Mixed {
    PackedBlock reached;
    std::unique_ptr<Sides> entered;  // what came in through its sides since it was flooded
    bool is_fresh = true;            // nothing that it holds was passed on
    bool is_queued = false;
    bool is_known = false;  // was queued
  };
  struct Passed {
    uint8_t sides = 0;  // bit side
    Sides bits;
  };

  size_t indexOf(const glm::ivec3& block) const {
    const glm::ivec3 at = block - box_.low;
    return size_t(at.x) + size_t(size_.x) * (size_t(at.y) + size_t(size_.y) * size_t(at.z));
  }
  glm::ivec3 placeOf(size_t index) const {
    const size_t x = size_t(size_.x), y = size_t(size_.y);
    return box_.low + glm::ivec3(int(index % x), int(index / x % y), int(index / (x * y)));
  }

  bool startInBlock(const glm::ivec3& block, const VoxelBox& voxels) {
    const uint32_t surface = surface_[indexOf(block)];
    if (surface == kNoSurface) {
      reachWhole(block);
      return true;
    }
    Mixed& mixed = mixed_[surface];
    const glm::ivec3 low = block * kBlockSide;
    const VoxelBox part =
        overlapOf({voxels.low - low, voxels.high - low}, {glm::ivec3(0), glm::ivec3(kBlockSide - 1)});
    BlockBits free, reached;
    freeOf(grid_.blocks[surface], options_.within, free);
    mixed.reached.addTo(reached);
    uint64_t any = 0;
    for (int z = part.low.z; z <= part.high.z; ++z) {
      for (int y = part.low.y; y <= part.high.y; ++y) {
        const uint64_t row = free.row(y, z) & rowBits(part.low.x, part.high.x);
        reached.row(y, z) |= row;
        any |= row;
      }
    }
    if (any == 0) return false;
    mixed.reached = packBlock(reached);
    queue(surface);
    return true;
  }

  void queue(uint32_t surface) {
    if (mixed_[surface].is_queued) return;
    mixed_[surface].is_queued = true;
    touched_ += mixed_[surface].is_known ? 0 : 1;
    mixed_[surface].is_known = true;
    queue_.push_back(surface);
  }

  void reachWhole(const glm::ivec3& block) {
    if (options_.within && !holds({options_.within->low >> 6, options_.within->high >> 6}, block)) return;
    uint8_t& is_reached = is_reached_[indexOf(block)];
    if (is_reached != 0) return;
    is_reached = 1;
    ++touched_;
    whole_.push_back(block);
  }

  // Into the block through its side.
  void enter(const glm::ivec3& block, int side, const BlockSide& bits) {
    const uint32_t surface = surface_[indexOf(block)];
    if (surface == kNoSurface) return reachWhole(block);
    Mixed& mixed = mixed_[surface];
    if (!mixed.entered) mixed.entered = std::make_unique<Sides>(Sides{});
    for (size_t i = 0; i < kBlockSide; ++i) (*mixed.entered)[size_t(side)][i] |= bits[i];
    queue(surface);
  }

  // Out of the block through its side.
  void leave(const glm::ivec3& block, int side, const BlockSide& bits) {
    const glm::ivec3 next = block + stepThrough(side);
    if (holds(box_, next)) return enter(next, side ^ 1, bits);
    if (mayLeave(side)) reachOutside();
  }

  // Whether paths may go on beyond the box through this side of it.
  bool mayLeave(int side) const {
    if (!options_.within) return true;
    const int axis = side / 2;
    return (side & 1) != 0 ? options_.within->high[axis] > box_.high[axis] * kBlockSide + (kBlockSide - 1)
                           : options_.within->low[axis] < box_.low[axis] * kBlockSide;
  }

  // From blocks that are reached as a whole.
  void spread() {
    while (!whole_.empty()) {
      const glm::ivec3 block = whole_.back();
      whole_.pop_back();
      for (int side = 0; side < kSides; ++side) leave(block, side, kFull);
    }
  }

  void flood(uint32_t surface, BlockBits& free, BlockBits& reached, Passed& passed) {
    Mixed& mixed = mixed_[surface];
    freeOf(grid_.blocks[surface], options_.within, free);
    reached.clear();
    mixed.reached.addTo(reached);
    const Sides before = mixed.is_fresh ? Sides{} : sidesOf(reached);
    BlockBits start = reached;
    if (mixed.entered) {
      for (int side = 0; side < kSides; ++side) addToSide(start, side, (*mixed.entered)[size_t(side)]);
      mixed.entered.reset();
    }
    std::array<uint64_t, kBlockSide> dirty{};
    for (int z = 0; z < kBlockSide; ++z) {
      for (int y = 0; y < kBlockSide; ++y) {
        const uint64_t row = start.row(y, z) & free.row(y, z);
        const uint64_t known = mixed.is_fresh ? 0 : reached.row(y, z);
        if (row != known) dirty[size_t(z)] |= uint64_t{1} << y;
        reached.row(y, z) = row;
      }
    }
    mixed.is_fresh = false;
    floodBlock(free, reached, dirty);
    mixed.reached = packBlock(reached);
    const Sides after = sidesOf(reached);
    for (int side = 0; side < kSides; ++side) {
      uint64_t any = 0;
      for (size_t i = 0; i < kBlockSide; ++i) {
        passed.bits[size_t(side)][i] = after[size_t(side)][i] & ~before[size_t(side)][i];
        any |= passed.bits[size_t(side)][i];
      }
      if (any != 0) passed.sides |= uint8_t(1 << side);
    }
  }

  static Sides sidesOf(const BlockBits& block) {
    Sides sides;
    for (int side = 0; side < kSides; ++side) sides[size_t(side)] = sideOf(block, side);
    return sides;
  }

  const BlockSide kFull = fullSide();
  const VoxelGrid& grid_;
  const ReachOptions& options_;
  VoxelBox box_;
  glm::ivec3 size_;
  std::vector<uint32_t> surface_;    // of each block of the box: its place in the grid, or kNoSurface
  std::vector<uint8_t> is_reached_;  // of each without surface
  std::vector<Mixed> mixed_;         // of each block of the grid
  std::vector<glm::ivec3> whole_;    // reached, and not yet left
  std::deque<uint32_t> queue_;       // places in the grid
  uint64_t touched_ = 0;
  bool is_outside_ = false;
};

double percentOf(uint64_t part, const SpaceCounts& counts) {
  const uint64_t all = counts.free + counts.inner;
  return all == 0 ? 0 : 100 * double(part) / double(all);
}

}  // namespace

VoxelSpace reach(const VoxelGrid& grid, const ReachOptions& options) {
  if (options.seeds.empty() && options.boxes.empty() && !options.from_outside) {
    throw Error("free space: no place to start from", kExitUsage);
  }
  Flood flood(grid, options);
  for (const glm::dvec3& seed : options.seeds) {
    const glm::ivec3 voxel = voxelAt(grid.lattice, seed);
    flood.startAt({voxel, voxel}, fmt::format("the place {:g},{:g},{:g}", seed.x, seed.y, seed.z));
  }
  for (const VoxelBox& box : options.boxes) {
    const glm::dvec3 low = glm::dvec3(box.low) * grid.lattice.voxelSize(),
                     high = glm::dvec3(box.high + 1) * grid.lattice.voxelSize();
    flood.startAt(box, fmt::format("the box from {:g},{:g},{:g} to {:g},{:g},{:g}", low.x, low.y, low.z,
                                   high.x, high.y, high.z));
  }
  if (options.from_outside) flood.reachOutside();
  flood.run();
  return flood.space();
}

std::string reachedText(const SpaceCounts& counts) {
  return fmt::format("{:.1f} % of space is reached", percentOf(counts.free, counts));
}

std::string insideText(const SpaceCounts& counts) {
  return fmt::format("{:.1f} % of space is inside", percentOf(counts.inner, counts));
}

}  // namespace sightline
