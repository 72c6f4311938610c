#pragma once
#include <array>
#include <cstdint>

#include "core/voxel/voxel_grid.h"

namespace sightline {

/// A layer of a block's voxels: word z, bit y of the sides along x; word z, bit x along y; word y, bit x
/// along z.
using BlockSide = std::array<uint64_t, kBlockSide>;

/// Sides of a block: low and high x, y, z.
inline constexpr int kSides = 6;

/// The bits that one of the neighbours through each side meets.
BlockSide sideOf(const BlockBits& block, int side);
void addToSide(BlockBits& block, int side, const BlockSide& bits);

/// Adds to `reached` all voxels of `free` that a path from face to face through `free` joins with one of it,
/// inside of the block. `reached` must be in `free`. Only rows of `dirty` (bit y of word z) are taken as new:
/// from the others all is reached already.
///
/// A row of 64 voxels at a time, by the parallel prefix fill of P. Kogge, H. Stone, A Parallel Algorithm for
/// the Efficient Solution of a General Class of Recurrence Equations, 1973, as chess programs use it.
void floodBlock(const BlockBits& free, BlockBits& reached, std::array<uint64_t, kBlockSide>& dirty);

}  // namespace sightline
