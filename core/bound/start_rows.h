#pragma once
#include <vector>

#include "core/bound/bound_scene.h"
#include "core/bound/cell_hull.h"
#include "core/cell/view_cell.h"

namespace sightline {

inline VoxelBox voxelsOf(const RealBox& box) {
  return {glm::ivec3(glm::floor(box.low)), glm::ivec3(glm::floor(box.high))};
}

/// Where paths from a cell begin: rows along x of voxels that no triangle (that stops rays) meets. These are
/// the voxels that the cell may meet. Where a triangle meets the cell itself, the cell may lie on both of its
/// sides, though on one of them in voxels with triangles only: so the voxels next to these count, too, and
/// next to those of the cell that hang together with them. Empty if triangles meet all of the cell's voxels.
/// hull: of the cell. region: of the cell and the scene, no row leaves it.
std::vector<VoxelBox> startRows(const BoundScene& scene, const ViewCell& cell, const CellHull& hull,
                                const VoxelBox& region);

}  // namespace sightline
