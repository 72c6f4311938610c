#pragma once
#include <atomic>
#include <functional>

#include "core/voxel/closed_parts.h"
#include "core/voxel/voxel_space.h"

namespace sightline {

struct SolidHooks {
  /// Told, on the caller's thread, what share of the work is done: 0 to 1, ascending.
  std::function<void(double done)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends it with Interrupted when it becomes true
};

/// Which voxels are inside of closed parts: inner are those that no triangle meets and that for some object
/// are inside of its closed parts together by the rule; all others that no triangle meets are free. Where the
/// parts of one object lie in each other or overlap, parity leaves hollow what an even number of them hold,
/// winding what they turn around in opposite ways.
///
/// Exact: a voxel that no triangle meets is wholly inside or wholly outside, and which of both, its middle
/// says: lines along x through the voxels' middles count the triangles that they cross, by orient2d, and
/// where one goes through an edge or corner, as if it lay higher by a vanishing bit along y, and by a smaller
/// one along z.
///
/// grid: of this scene, with its blocks' triangles (VoxelizeOptions::with_triangles). parts: closedParts of
/// the scene by the same rule. The same on any number of threads. Throws as VoxelSpace, and Interrupted.
VoxelSpace solidParts(const Scene& scene, const VoxelGrid& grid, const ClosedParts& parts, InsideRule rule,
                      const SolidHooks& hooks = {});

}  // namespace sightline
