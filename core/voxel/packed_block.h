#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/voxel/voxel_grid.h"

namespace sightline {

/// How much of something is in a set.
enum class Share : uint8_t { kNone, kSome, kAll };

/// A set of voxels of a block in little memory: bits only for bricks of which a part is in the set.
struct PackedBlock {
  using Brick = std::array<uint64_t, 8>;  ///< as VoxelBrick::bits

  std::array<uint64_t, 8> all{};   ///< word z, bit x + 8 y of a brick: all its voxels are in the set
  std::array<uint64_t, 8> some{};  ///< some of them are, and others not
  std::vector<Brick> bits;         ///< of the bricks of `some`, z, then y, then x ascending

  /// Of the cube of 2^level voxels a side, level 0 to 6, from `low` in the block on, a multiple of its side.
  Share shareOf(const glm::ivec3& low, int level) const;
  bool contains(const glm::ivec3& voxel) const { return shareOf(voxel, 0) == Share::kAll; }
  uint64_t count() const;
  /// Adds its voxels.
  void addTo(BlockBits& block) const;
};

/// Where the bits of a brick of `some` are in PackedBlock::bits.
inline size_t placeOfBits(const uint64_t* some, const glm::ivec3& brick) {
  const int bit = brick.x + 8 * brick.y;
  size_t place = size_t(std::popcount(some[brick.z] & ((uint64_t{1} << bit) - 1)));
  for (int z = 0; z < brick.z; ++z) place += size_t(std::popcount(some[z]));
  return place;
}

PackedBlock packBlock(const BlockBits& block);

}  // namespace sightline
