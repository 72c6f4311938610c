#include "core/voxel/voxels_below.h"

namespace sightline {
namespace {

/// The brick without its rows from `rows` on.
VoxelBrick lowRows(VoxelBrick brick, int64_t rows) {
  const uint64_t kept = rows >= kBrickSide ? ~uint64_t{0} : rows <= 0 ? 0 : (uint64_t{1} << (8 * rows)) - 1;
  for (uint64_t& word : brick.bits) word &= kept;
  return brick;
}

}  // namespace

VoxelGrid voxelsBelow(const VoxelGrid& grid, int64_t end) {
  VoxelGrid result;
  result.lattice = grid.lattice;
  for (const VoxelBlock& block : grid.blocks) {
    const int64_t rows = end - int64_t(block.place.y) * kBlockSide;
    if (rows <= 0) continue;
    VoxelBlock part = block;
    part.bricks.clear();
    for (const VoxelBrick& brick : block.bricks) {
      const VoxelBrick low = lowRows(brick, rows - kBrickSide * ((brick.place >> 3) & 7));
      if (low.count() != 0) part.bricks.push_back(low);
    }
    if (!part.bricks.empty()) result.blocks.push_back(std::move(part));
  }
  return result;
}

}  // namespace sightline
