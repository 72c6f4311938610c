#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>

#include "core/voxel/bin_triangles.h"
#include "core/voxel/separating_rows.h"
#include "core/voxel/voxel_attributes.h"
#include "core/voxel/voxel_grid.h"

namespace sightline {

struct VoxelizeOptions {
  Lattice lattice;
  Separation separation = Separation::kConservative;
  bool with_triangles = true;        ///< keep each block's ids
  WantedAttributes attributes = {};  ///< of each voxel
  /// Bytes that lists of triangles may take at once, beside the scene: with fewer, more passes over the
  /// scene. At least one layer of blocks is worked on at once, whatever it takes.
  uint64_t memory = uint64_t(1) << 30;
  /// Told, on the caller's thread, how much of the work is done: 0 to 1, ascending.
  std::function<void(double done, uint64_t voxels)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends it with Interrupted when it becomes true
};

/// The voxels whose closed cube meets a triangle of the scene, all of them and no other: every point of a
/// triangle is in one, and each has a point of a triangle. Or those of them that separate (SeparatingRows):
/// then a block's ids are those of the triangles that meet its closed cube, and blocks without voxels do not
/// come. Triangles are closed, without area they count too;
/// holes of masked surfaces do not matter here. Blocks come to `take` on the caller's thread, in order
/// (placeBefore). The same bytes on any number of threads and with any `memory`. Throws as requireFits, and
/// Interrupted.
void voxelize(const Scene& scene, const VoxelizeOptions& options,
              const std::function<void(VoxelBlock&&)>& take);

/// The same, in memory.
VoxelGrid voxelize(const Scene& scene, const VoxelizeOptions& options);

/// Who does the two things that voxelising is made of, with results as those of this room's functions.
struct VoxelizeSteps {
  /// As binTriangles.
  std::function<BlockTriangles(const VoxelBox& blocks)> bin;
  /// Makes blocks' bricks (VoxelBlock::place is given) from the triangles of binned.of(filled[i]), blocks[i]
  /// being block filled[i]. filled: ascending, with a triangle each.
  std::function<void(const BlockTriangles& binned, std::span<const size_t> filled,
                     std::span<VoxelBlock> blocks)>
      make;
  size_t blocks_a_time = 512;
};

/// voxelize by those steps.
void voxelizeBy(const VoxelizeSteps& steps, const Scene& scene, const VoxelizeOptions& options,
                const std::function<void(VoxelBlock&&)>& take);

}  // namespace sightline
