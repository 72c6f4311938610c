#pragma once
#include <atomic>
#include <functional>

#include "core/bound/blocked_space.h"
#include "core/bound/cell_hull.h"
#include "core/voxel/voxel_grid.h"

namespace sightline {

struct HideOptions {
  /// All segments that matter lie within these voxels: the box around cell and scene.
  VoxelBox region;
  int free_side = 16;     ///< cubes without triangles are not looked into below this side: a power of two
  int surface_side = 8;   ///< nor are others below this one
  double part_size = 16;  ///< of parts of the cell, in voxels: LayerSearch
  /// Told, on the caller's thread, how much of the work is done: 0 to 1, ascending.
  std::function<void(double done)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends it with Interrupted when it becomes true
};

/// Adds to `blocked`, which holds opaque voxels, those that are hidden from the cell: every segment from a
/// point of the cell to a point of such a voxel has a point in an opaque one. What is not added may be hidden
/// or not. surface: voxels of which it matters whether they are hidden; they are looked at one by one, others
/// in cubes of free_side.
///
/// A cube is hidden if between it and the cell there is a layer of voxels across x, y or z in which all
/// segments cross voxels that are opaque, or hidden already: what is behind a hidden voxel is hidden, too. So
/// a layer may be made of many occluders next to each other, and of the shadows of others in front of it.
///
///     cell      |h|o|            o opaque, h hidden: all segments from the cell to the cube
///    +----+-----|h|o|---+----+   cross the layer in these
///    |    |     |o| |   |cube|
///    +----+-----|o| |---+----+
///
/// Blocks are looked at from near to far, each as an octree; layers are tried where the segment between the
/// middles of cell and cube is blocked.
///
/// Based on: G. Schaufler, J. Dorsey, X. Decoret, F. Sillion, Conservative Volumetric Visibility with
/// Occluder Fusion, 2000: opaque and hidden voxels as occluders. They extend a blocker to a box and take its
/// umbra; here, each cube looks for a layer that hides it, whatever it is made of, and no umbra is formed.
///
/// The same on any number of threads. Throws Interrupted.
void hide(const CellHull& hull, const VoxelGrid& surface, const HideOptions& options, BlockedSpace& blocked);

}  // namespace sightline
