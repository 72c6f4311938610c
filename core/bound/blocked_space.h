#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/voxel/packed_block.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {

/// A block's voxels with all their bits, for work on one block.
struct OpenBlock {
  using Brick = std::array<uint64_t, 8>;  ///< word z, bit x + 8 y

  std::array<uint64_t, 8> all{};   ///< word z, bit x + 8 y of a brick: all its voxels are in the set
  std::array<uint64_t, 8> some{};  ///< some of them are, and others not
  std::vector<Brick> bits = std::vector<Brick>(512);

  void assign(const PackedBlock& packed);
  /// Adds the cube of that side (a power of two up to 64) from `low` in the block on, a multiple of the side.
  void insert(const glm::ivec3& low, int side);
  PackedBlock packed() const;
  bool isFull() const;
};

/// Voxels through which nothing is seen: opaque, or hidden from the cell. A set of voxels of a box of blocks
/// that grows. For reading by many threads at once.
class BlockedSpace {
 public:
  /// Empty. Throws Error where the box holds more than kMostBlocks.
  explicit BlockedSpace(const VoxelBox& blocks);

  const VoxelBox& blocks() const { return blocks_; }
  Share share(const glm::ivec3& block) const;
  /// Of a block of which some is in the set.
  const PackedBlock& packed(const glm::ivec3& block) const { return packed_[entry(block) - kPacked]; }
  bool contains(const glm::ivec3& voxel) const;
  uint64_t count() const;

  /// Replaces what a block has.
  void set(const glm::ivec3& block, Share share, PackedBlock&& packed = {});

  static constexpr uint64_t kMostBlocks = uint64_t(1) << 28;

 private:
  static constexpr uint32_t kNone = 0, kAll = 1, kPacked = 2;

  VoxelBox blocks_;
  glm::ivec3 size_;
  std::vector<uint32_t> entries_;  ///< of each block: kNone, kAll, or kPacked + its place
  std::vector<PackedBlock> packed_;
  std::vector<uint32_t> free_;  ///< places in packed_

  size_t indexOf(const glm::ivec3& block) const {
    const glm::ivec3 at = block - blocks_.low;
    return size_t(at.x) + size_t(size_.x) * (size_t(at.y) + size_t(size_.y) * size_t(at.z));
  }
  uint32_t entry(const glm::ivec3& block) const {
    const glm::ivec3 at = block - blocks_.low;
    const bool within = unsigned(at.x) < unsigned(size_.x) && unsigned(at.y) < unsigned(size_.y) &&
                        unsigned(at.z) < unsigned(size_.z);
    return within ? entries_[indexOf(block)] : kNone;
  }
  friend class BlockedView;
};

/// A blocked space, in which one block is looked up in its own copy. For one thread.
class BlockedView {
 public:
  explicit BlockedView(const BlockedSpace& space) : space_(space) {}
  void setOwn(const glm::ivec3& place, const OpenBlock* own) {
    own_place_ = place;
    own_ = own;
    at_ = glm::ivec3(INT32_MIN);
  }

  /// A cube of voxels that are all in the set, or none of them: 64, 8 or 1 a side.
  struct Cube {
    bool blocked;
    int side;
  };
  Cube cubeAt(const glm::ivec3& voxel);

  /// Calls visit(share, blocked) for the cubes that a segment passes, with the share of it (0 .. 1, rounded)
  /// at which it comes to each, until it returns false. nudge: the share by which it goes past each, in spite
  /// of rounding; cubes that the segment crosses for less may be left out.
  template <typename Visit>
  void visitAlong(const glm::dvec3& from, const glm::dvec3& way, double nudge, Visit&& visit) {
    for (double share = 0; share < 1;) {
      const glm::ivec3 voxel(glm::floor(from + way * share));
      const Cube cube = cubeAt(voxel);
      if (!visit(share, cube.blocked)) return;
      double end = 1;
      for (int axis = 0; axis < 3; ++axis) {
        if (way[axis] == 0) continue;
        const int low = voxel[axis] & -cube.side;
        end = std::min(end, (double(way[axis] > 0 ? low + cube.side : low) - from[axis]) / way[axis]);
      }
      share = std::max(end, share) + nudge;
    }
  }

  /// Whether all voxels of a layer across the axis, from low to high (both with their ends) along the next
  /// two axes u and v, are in the set. layer[axis] is the layer.
  bool covers(int axis, const VoxelBox& layer);

 private:
  enum class Kind { kNone, kAll, kPacked, kOwn };
  void goTo(const glm::ivec3& block);
  const std::array<uint64_t, 8>* brickAt(const glm::ivec3& brick) const;

  const BlockedSpace& space_;
  glm::ivec3 own_place_{INT32_MIN};
  const OpenBlock* own_ = nullptr;
  glm::ivec3 at_{INT32_MIN};  ///< the block looked at last
  Kind kind_ = Kind::kNone;
  const uint64_t* all_ = nullptr;
  const uint64_t* some_ = nullptr;
  const std::array<uint64_t, 8>* bits_ = nullptr;
};

}  // namespace sightline
