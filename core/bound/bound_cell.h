#pragma once
#include <atomic>
#include <functional>
#include <vector>

#include "core/bound/blocked_space.h"
#include "core/bound/bound_scene.h"
#include "core/cell/view_cell.h"

namespace sightline {

struct BoundOptions {
  // What to spend on it: the more, the more is proved.
  int free_side = 16;             ///< HideOptions
  int surface_side = 8;           ///< HideOptions
  double part_size = 16;          ///< HideOptions
  double triangle_part_size = 4;  ///< the same for triangles, each of which is looked at voxel by voxel
  std::function<void(double done)> progress = {};
  const std::atomic<bool>* stop = nullptr;
};

/// What of a scene may be seen from a cell, at most.
struct CellBound {
  std::vector<uint32_t> triangles;  ///< not proved hidden: ascending
  uint64_t opaque_voxels = 0;       ///< of innerVoxels; none: nothing can be proved
  uint64_t hidden_voxels = 0;       ///< others that are proved hidden
};

/// The voxels that are opaque to the cell: no triangle (that stops rays) meets them, and no path from face to
/// face of voxels without leads to them from the cell, inside of the box around the cell and the scene, which
/// no segment between the two leaves. Where a triangle meets the cell, paths begin on both of its sides. None
/// if triangles meet all of the cell's voxels.
BlockedSpace innerVoxels(const BoundScene& scene, const ViewCell& cell,
                         const std::atomic<bool>* stop = nullptr);

/// Every triangle with a point that a segment from a point of the cell meets before any other triangle is in
/// the bound, but for leaks: those whose every such segment passes a voxel that is opaque to the cell, which
/// it can enter only by a gap that no path of voxels without triangles fits through: at most 2 voxels wide
/// between walls along the axes, 2 sqrt(3) between others. So are all with a point in the cell. Of a flat
/// cell, what lies wholly behind its plane is hidden. The cell is in the scene's space (Scene::offset taken
/// off). The same on any number of threads. Throws Interrupted.
CellBound boundCell(const BoundScene& scene, const ViewCell& cell, const BoundOptions& options = {});

/// The same by other opaque voxels.
CellBound boundCell(const BoundScene& scene, const ViewCell& cell, BlockedSpace&& opaque,
                    const BoundOptions& options = {});

}  // namespace sightline
