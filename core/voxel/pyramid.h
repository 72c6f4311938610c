#pragma once
#include <array>
#include <functional>
#include <map>
#include <vector>

#include "core/voxel/voxel_grid.h"

namespace sightline {

/// Makes blocks of voxels twice as large from blocks in order: a voxel is in the coarser set if one of the
/// eight that it consists of is in the finer one. Coarser blocks hold no ids.
class CoarserBlocks {
 public:
  /// take: gets the coarser blocks, in order.
  explicit CoarserBlocks(std::function<void(VoxelBlock&&)> take) : take_(std::move(take)) {}
  void add(const VoxelBlock& block);
  /// After the last block.
  void finish();

 private:
  std::function<void(VoxelBlock&&)> take_;
  int layer_ = 0;                                    ///< z of the blocks at work
  std::map<std::array<int, 2>, VoxelBlock> blocks_;  ///< by y and x
};

/// The set's next coarser level.
VoxelGrid coarser(const VoxelGrid& grid);

/// Whether the grid needs no coarser level: it is in 2 voxels along each axis, at most (all the way up, a set
/// on both sides of the lattice's origin is in 2).
bool isRoot(const VoxelGrid& grid);

/// The set and its coarser levels, up to the first that is a root.
std::vector<VoxelGrid> pyramidOf(VoxelGrid finest);

}  // namespace sightline
