#pragma once
#include <array>
#include <bit>
#include <compare>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/voxel/lattice.h"
#include "core/voxel/voxel_box.h"

namespace sightline {

/// Voxels along the side of a brick, and of a block.
inline constexpr int kBrickSide = 8;
inline constexpr int kBlockSide = 64;

/// 8 x 8 x 8 voxels of a block, at least one of them in the set.
struct VoxelBrick {
  uint16_t place = 0;              ///< x + 8 y + 64 z of the brick in its block
  std::array<uint64_t, 8> bits{};  ///< word z, bit x + 8 y: whether the voxel is in the set

  bool contains(int x, int y, int z) const { return ((bits[size_t(z)] >> (x + 8 * y)) & 1) != 0; }
  uint32_t count() const {
    uint32_t sum = 0;
    for (const uint64_t word : bits) sum += uint32_t(std::popcount(word));
    return sum;
  }
  bool operator==(const VoxelBrick&) const = default;
};

/// 64 x 64 x 64 voxels, at least one of them in the set.
struct VoxelBlock {
  glm::ivec3 place{0};             ///< its lowest voxel is 64 place
  std::vector<VoxelBrick> bricks;  ///< ascending in place
  std::vector<uint32_t>
      triangles;  ///< ids of those that meet one of its voxels, ascending; empty if not asked for
  std::vector<uint32_t> normals;  ///< of each voxel by its rank (VoxelRanks), as packNormal makes them;
                                  ///< empty if not asked for (core/voxel/voxel_attributes.h)
  std::vector<uint32_t> objects;  ///< likewise: places in Scene::objects

  uint64_t count() const {
    uint64_t sum = 0;
    for (const VoxelBrick& brick : bricks) sum += brick.count();
    return sum;
  }
  bool operator==(const VoxelBlock&) const = default;
};

/// Order of blocks: z, then y, then x.
inline bool placeBefore(const glm::ivec3& a, const glm::ivec3& b) {
  return std::array{a.z, a.y, a.x} < std::array{b.z, b.y, b.x};
}

/// A set of voxels: blocks in the order of placeBefore, each once.
struct VoxelGrid {
  Lattice lattice;
  std::vector<VoxelBlock> blocks;

  uint64_t count() const {
    uint64_t sum = 0;
    for (const VoxelBlock& block : blocks) sum += block.count();
    return sum;
  }
};

/// The smallest box that holds the block's voxels.
VoxelBox boxOf(const VoxelBlock& block);
/// And a grid's.
VoxelBox boxOf(const VoxelGrid& grid);

/// Finds voxels of a grid, which must stay where it is. For use by many threads at once.
class VoxelLookup {
 public:
  explicit VoxelLookup(const VoxelGrid& grid);
  /// nullptr: no voxel of that block is in the set.
  const VoxelBlock* block(const glm::ivec3& place) const;
  bool contains(const glm::ivec3& voxel) const;

 private:
  const VoxelGrid* grid_;
  std::unordered_map<uint64_t, uint32_t> places_;
};

/// One bit a voxel of a block: word y + 64 z, bit x.
class BlockBits {
 public:
  BlockBits() : words_(size_t(kBlockSide) * kBlockSide, 0) {}
  uint64_t& row(int y, int z) { return words_[size_t(y + kBlockSide * z)]; }
  uint64_t row(int y, int z) const { return words_[size_t(y + kBlockSide * z)]; }
  void clear() { std::fill(words_.begin(), words_.end(), 0); }
  /// The bricks with a voxel in the set, ascending in place.
  std::vector<VoxelBrick> bricks() const;
  /// Adds those of the bricks.
  void insert(std::span<const VoxelBrick> bricks);
  /// Bits of a brick, as VoxelBrick has them, by its place in the block along each axis.
  std::array<uint64_t, 8> brick(const glm::ivec3& place) const;
  /// Adds these.
  void insert(const glm::ivec3& place, const std::array<uint64_t, 8>& bits);

 private:
  std::vector<uint64_t> words_;
};

/// Voxels from low to high, both with their ends, as bits of a row of a block: 0 <= low, high < 64; none if
/// low > high.
inline uint64_t rowBits(int low, int high) {
  return low > high ? 0 : (~uint64_t{0} << low) & (~uint64_t{0} >> (63 - high));
}

}  // namespace sightline
