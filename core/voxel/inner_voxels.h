#pragma once
#include "core/voxel/voxel_space.h"

namespace sightline {

/// The inner voxels of a space, as a set: those of the blocks that it knows (VoxelSpace::blocks).
VoxelGrid innerVoxels(const VoxelSpace& space);

}  // namespace sightline
