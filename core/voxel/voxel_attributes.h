#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/voxel/voxel_grid.h"

namespace sightline {

/// Ranks of a block's voxels: their places in its attributes. Bricks in order, in a brick word by word, bit
/// by bit.
class VoxelRanks {
 public:
  explicit VoxelRanks(const VoxelBlock& block);
  /// Of a voxel of the set, counted from the block's lowest.
  uint32_t of(int x, int y, int z) const;

 private:
  const VoxelBlock& block_;
  std::array<int16_t, 512> brick_at_;  ///< -1: no voxel there
  std::vector<uint32_t> first_;        ///< rank of the first voxel of each word of each brick
};

/// A direction in 32 bits: x in the lowest ten, then y, then z, each a whole number of 1/511 in two's
/// complement. 0: none. Based on: M. G. Chajdas, A Voxel-Based Visualization Pipeline, 2015, section 4.3.2.
uint32_t packNormal(const glm::dvec3& direction);
glm::dvec3 unpackNormal(uint32_t packed);  ///< not normalised

struct WantedAttributes {
  bool normals = false;
  bool objects = false;
};

/// Fills VoxelBlock::normals and objects for the voxels of the block. A triangle counts in each voxel by the
/// area of what of it lies in the voxel's closed cube.
/// - Normal: the mean of the triangles' normals (a, b, c counterclockwise), by area; none (0) where there is
///   no area, or where fronts and backs cancel out.
/// - Object: the place in Scene::objects of that which has most area; of several, or where there is no area,
///   the lowest.
/// triangles: all that meet the block, ascending. In doubles, and the same on every run. Where an object's
/// share is next to another's, within rounding, either may win.
void addAttributes(const Scene& scene, std::span<const uint32_t> triangles, WantedAttributes wanted,
                   const Lattice& lattice, VoxelBlock& block);

}  // namespace sightline
