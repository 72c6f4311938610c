#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/voxel/voxel_space.h"

namespace sightline {

struct ReachOptions {
  /// Places to start from, in the scene's space: each in a voxel that no triangle meets.
  std::vector<glm::dvec3> seeds = {};
  /// Boxes of voxels to start from: all of their voxels that no triangle meets; each has one at least.
  std::vector<VoxelBox> boxes = {};
  bool from_outside = false;  ///< start from far outside of the scene, too
  /// No path leaves these voxels, which hold all places to start from: what nothing passes that stays within,
  /// such as sight between places in a box, does not come in from outside. Of voxels beyond it nothing is
  /// said.
  std::optional<VoxelBox> within = {};
  /// Told, on the caller's thread, what share of the space was looked at: 0 to 1, ascending.
  std::function<void(double done)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends it with Interrupted when it becomes true
};

/// The space that is reached: voxels that no triangle meets (the grid's are those that one meets) and that a
/// path from face to face through such voxels joins with where it starts, are free; others that no triangle
/// meets, inner. The space has no end: who leaves the box around the scene is outside, and comes back in from
/// everywhere.
///
/// The same on any number of threads. Throws Error that names the place (exit code 2) if a seed is in a voxel
/// with a triangle, or no voxel of a box is free of them; if there is nothing to start from; as VoxelSpace;
/// and Interrupted.
VoxelSpace reach(const VoxelGrid& grid, const ReachOptions& options);

/// "97.3 % of space is reached": of the box around the scene, without voxels that a triangle meets.
std::string reachedText(const SpaceCounts& counts);
/// "12.4 % of space is inside", of the same.
std::string insideText(const SpaceCounts& counts);

}  // namespace sightline
