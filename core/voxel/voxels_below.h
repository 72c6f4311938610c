#pragma once
#include "core/voxel/voxel_grid.h"

namespace sightline {

/// The voxels of the set below the plane y = end, in voxels: what a set cut open there shows.
VoxelGrid voxelsBelow(const VoxelGrid& grid, int64_t end);

}  // namespace sightline
