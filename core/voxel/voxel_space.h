#pragma once
#include <cstdint>
#include <vector>

#include "core/voxel/packed_block.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {

enum class VoxelState : uint8_t {
  kFree,     ///< of the space in which one may be
  kSurface,  ///< a triangle meets it
  kInner,    ///< neither: sealed off, or inside of something solid (who made the space says which)
};

/// Voxels of a part of space by their state.
struct SpaceCounts {
  uint64_t free = 0, surface = 0, inner = 0;
};

/// The state of every voxel of space: some 100 bytes to some KiB for each block that holds a triangle, 4
/// bytes for each other one of the box around these. Made by reach (core/voxel/reach.h) and solidParts
/// (core/voxel/solid.h). For use by many threads at once.
class VoxelSpace {
 public:
  /// grid must stay where it is, and not change. All is free at first. Throws Error where the box around its
  /// blocks holds more than kMostSpaceBlocks.
  explicit VoxelSpace(const VoxelGrid& grid);

  const VoxelGrid& grid() const { return *grid_; }
  /// The blocks from which on all is alike; none if the grid is empty.
  const VoxelBox& blocks() const { return blocks_; }
  /// State of all voxels outside of blocks().
  VoxelState outside() const { return outside_inner_ ? VoxelState::kInner : VoxelState::kFree; }

  VoxelState state(const glm::ivec3& voxel) const;
  /// How much of a cube of 2^level voxels a side is inner; `low`, its lowest voxel, is a multiple of the
  /// side. Any level from 0 to 20: up to 6 in constant time, above that as many steps as the cube has blocks
  /// at most.
  Share innerIn(const glm::ivec3& low, int level) const;
  /// The same of a block.
  Share innerInBlock(const glm::ivec3& place) const;
  /// Of the smallest box around the surface's voxels.
  SpaceCounts counts() const;
  /// The voxels of a block that are free, and those that a triangle meets.
  void bitsOf(const glm::ivec3& place, BlockBits& free, BlockBits& surface) const;

  /// For who makes one: what is inner in a block; not for use by many threads at once.
  void setInner(const glm::ivec3& block, Share share, PackedBlock&& packed = {});
  void setOutsideInner(bool inner) { outside_inner_ = inner; }

 private:
  static constexpr uint32_t kNone = 0, kAll = 1, kPacked = 2;

  const VoxelGrid* grid_;
  VoxelLookup lookup_;
  VoxelBox blocks_;
  bool outside_inner_ = false;
  std::vector<uint32_t> inner_;  ///< of each block of blocks_: kNone, kAll, or kPacked + its place
  std::vector<PackedBlock> packed_;

  size_t indexOf(const glm::ivec3& block) const;
};

/// The grid's voxels and the inner ones of the box around them, as one set; blocks keep their triangles.
VoxelGrid filledGrid(const VoxelSpace& space);

/// Blocks of a box that a space may have at most.
inline constexpr uint64_t kMostSpaceBlocks = uint64_t(1) << 28;

/// The box around the grid's blocks, in blocks; none if there are none.
VoxelBox blocksAround(const VoxelGrid& grid);

/// The voxel that holds a place of the scene's space, the higher one if it is on a side. Places out of range
/// of int32 are moved to its ends.
glm::ivec3 voxelAt(const Lattice& lattice, const glm::dvec3& place);

inline bool holds(const VoxelBox& box, const glm::ivec3& place) {
  return glm::all(glm::greaterThanEqual(place, box.low)) && glm::all(glm::lessThanEqual(place, box.high));
}

}  // namespace sightline
