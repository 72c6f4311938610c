#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/voxel/lattice.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {

/// Which triangles meet which block, for the blocks of a box.
struct BlockTriangles {
  VoxelBox blocks;  ///< the box, in blocks
  std::vector<uint64_t>
      first;                  ///< of each block, x fastest, then y, then z, and one more: where its ids begin
  std::vector<uint32_t> ids;  ///< ascending in each block

  std::span<const uint32_t> of(size_t block) const {
    return std::span(ids).subspan(first[block], first[block + 1] - first[block]);
  }
  glm::ivec3 placeOf(size_t block) const {
    const size_t x = size_t(blocks.high.x - blocks.low.x) + 1, y = size_t(blocks.high.y - blocks.low.y) + 1;
    return blocks.low + glm::ivec3(int(block % x), int(block / x % y), int(block / (x * y)));
  }
};

/// Exactly those with a point in the block's closed cube. Same result on any number of threads.
/// The box has fewer than 2^31 blocks.
BlockTriangles binTriangles(const Scene& scene, const Lattice& lattice, const VoxelBox& blocks);

/// How many pairs of a triangle and a block there are at most in each layer of blocks along z, from the box's
/// lowest layer on.
std::vector<uint64_t> countPairsOfLayers(const Scene& scene, const Lattice& lattice, const VoxelBox& blocks);

/// Corners in voxels of the lattice.
inline std::array<glm::dvec3, 3> inVoxels(const std::array<glm::vec3, 3>& corners, double voxels_a_unit) {
  return {glm::dvec3(corners[0]) * voxels_a_unit, glm::dvec3(corners[1]) * voxels_a_unit,
          glm::dvec3(corners[2]) * voxels_a_unit};
}

}  // namespace sightline
