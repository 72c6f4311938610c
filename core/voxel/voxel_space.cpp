#include "core/voxel/voxel_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace sightline {
namespace {

uint64_t volumeOf(const VoxelBox& box) {
  const glm::i64vec3 size = glm::max(glm::i64vec3(box.high) - glm::i64vec3(box.low) + int64_t(1), int64_t(0));
  return uint64_t(size.x) * uint64_t(size.y) * uint64_t(size.z);
}

}  // namespace

VoxelBox blocksAround(const VoxelGrid& grid) {
  VoxelBox box;
  for (const VoxelBlock& block : grid.blocks) {
    if (box.low.x > box.high.x) box = {block.place, block.place};
    box = {glm::min(box.low, block.place), glm::max(box.high, block.place)};
  }
  return box;
}

glm::ivec3 voxelAt(const Lattice& lattice, const glm::dvec3& place) {
  const double voxels_a_unit = std::ldexp(1.0, -lattice.exponent);
  return glm::ivec3(glm::clamp(glm::floor(place * voxels_a_unit), -0x1p31, 0x1p31 - 1));
}

VoxelSpace::VoxelSpace(const VoxelGrid& grid) : grid_(&grid), lookup_(grid), blocks_(blocksAround(grid)) {
  const uint64_t count = volumeOf(blocks_);
  if (count > kMostSpaceBlocks) {
    throw Error(
        fmt::format("space around the scene is {} blocks of {} voxels a side, more than {}: take "
                    "larger voxels",
                    count, kBlockSide, kMostSpaceBlocks));
  }
  inner_.assign(count, kNone);
}

size_t VoxelSpace::indexOf(const glm::ivec3& block) const {
  const glm::ivec3 size = blocks_.high - blocks_.low + 1, at = block - blocks_.low;
  return size_t(at.x) + size_t(size.x) * (size_t(at.y) + size_t(size.y) * size_t(at.z));
}

VoxelState VoxelSpace::state(const glm::ivec3& voxel) const {
  const glm::ivec3 block = voxel >> 6;
  if (!holds(blocks_, block)) return outside();
  const uint32_t inner = inner_[indexOf(block)];
  if (inner == kAll) return VoxelState::kInner;
  if (inner >= kPacked && packed_[inner - kPacked].contains(voxel & 63)) return VoxelState::kInner;
  return lookup_.contains(voxel) ? VoxelState::kSurface : VoxelState::kFree;
}

Share VoxelSpace::innerInBlock(const glm::ivec3& place) const {
  if (!holds(blocks_, place)) return outside_inner_ ? Share::kAll : Share::kNone;
  const uint32_t inner = inner_[indexOf(place)];
  return inner == kNone ? Share::kNone : inner == kAll ? Share::kAll : Share::kSome;
}

Share VoxelSpace::innerIn(const glm::ivec3& low, int level) const {
  const glm::ivec3 block = low >> 6;
  if (level <= 6) {
    if (!holds(blocks_, block)) return outside_inner_ ? Share::kAll : Share::kNone;
    const uint32_t inner = inner_[indexOf(block)];
    if (inner < kPacked) return inner == kNone ? Share::kNone : Share::kAll;
    return packed_[inner - kPacked].shareOf(low & 63, level);
  }
  const int side = 1 << (level - 6);
  const VoxelBox cube{block, block + (side - 1)};
  const VoxelBox part = overlapOf(cube, blocks_);
  const bool leaves = !(part.low == cube.low && part.high == cube.high);
  bool any = leaves && outside_inner_, all = !leaves || outside_inner_;
  for (int z = part.low.z; z <= part.high.z; ++z) {
    for (int y = part.low.y; y <= part.high.y; ++y) {
      for (int x = part.low.x; x <= part.high.x; ++x) {
        const uint32_t inner = inner_[indexOf({x, y, z})];
        any = any || inner != kNone;
        all = all && inner == kAll;
        if (any && !all) return Share::kSome;
      }
    }
  }
  return all ? Share::kAll : any ? Share::kSome : Share::kNone;
}

SpaceCounts VoxelSpace::counts() const {
  SpaceCounts counts;
  const uint64_t volume = volumeOf(boxOf(*grid_));
  counts.surface = grid_->count();
  constexpr uint64_t kInBlock = uint64_t(kBlockSide) * kBlockSide * kBlockSide;
  for (const uint32_t inner : inner_) {
    counts.inner += inner == kNone ? 0 : inner == kAll ? kInBlock : packed_[inner - kPacked].count();
  }
  // Of the blocks' voxels beside the box, all are as outside.
  if (outside_inner_) counts.inner -= kInBlock * inner_.size() - volume;
  counts.free = volume - counts.surface - counts.inner;
  return counts;
}

void VoxelSpace::bitsOf(const glm::ivec3& place, BlockBits& free, BlockBits& surface) const {
  surface.clear();
  free.clear();
  if (const VoxelBlock* block = lookup_.block(place)) surface.insert(block->bricks);
  const Share inner = innerInBlock(place);
  if (inner == Share::kAll) return;
  if (inner == Share::kSome) packed_[inner_[indexOf(place)] - kPacked].addTo(free);
  for (int z = 0; z < kBlockSide; ++z) {
    for (int y = 0; y < kBlockSide; ++y) free.row(y, z) = ~(free.row(y, z) | surface.row(y, z));
  }
}

void VoxelSpace::setInner(const glm::ivec3& block, Share share, PackedBlock&& packed) {
  uint32_t& inner = inner_[indexOf(block)];
  inner = share == Share::kNone ? kNone : share == Share::kAll ? kAll : kPacked + uint32_t(packed_.size());
  if (share == Share::kSome) packed_.push_back(std::move(packed));
}

VoxelGrid filledGrid(const VoxelSpace& space) {
  VoxelGrid filled;
  filled.lattice = space.grid().lattice;
  const VoxelBox voxels = boxOf(space.grid()), blocks = space.blocks();
  const VoxelLookup lookup(space.grid());
  BlockBits free, surface;
  for (int z = blocks.low.z; z <= blocks.high.z; ++z) {
    for (int y = blocks.low.y; y <= blocks.high.y; ++y) {
      for (int x = blocks.low.x; x <= blocks.high.x; ++x) {
        const VoxelBlock* block = lookup.block({x, y, z});
        if (block == nullptr && space.innerInBlock({x, y, z}) == Share::kNone) continue;
        const glm::ivec3 low = glm::ivec3(x, y, z) * kBlockSide;
        const VoxelBox part =
            overlapOf({voxels.low - low, voxels.high - low}, {glm::ivec3(0), glm::ivec3(kBlockSide - 1)});
        space.bitsOf({x, y, z}, free, surface);
        surface.clear();
        for (int k = part.low.z; k <= part.high.z; ++k) {
          for (int j = part.low.y; j <= part.high.y; ++j) {
            surface.row(j, k) = ~free.row(j, k) & rowBits(part.low.x, part.high.x);
          }
        }
        VoxelBlock whole;
        whole.place = {x, y, z};
        whole.bricks = surface.bricks();
        if (block != nullptr) whole.triangles = block->triangles;
        if (!whole.bricks.empty()) filled.blocks.push_back(std::move(whole));
      }
    }
  }
  return filled;
}

}  // namespace sightline
