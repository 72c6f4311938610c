#pragma once
#include <cstdint>
#include <vector>

#include "bvh/bvh.h"
#include "core/cell/view_cell.h"
#include "core/scene/scene.h"

namespace sightline {

/// Triangles that the view cell contains in part, in ascending order: no ray that leaves the cell's surface
/// shows them, yet a viewer in the cell may see them. Degenerate triangles are left out.
///
/// Boxes and sheets: those that meet the closed box. So a triangle that only touches the box from outside
/// counts, such as the floor that a cell stands on: from just above it, it is seen, and rays from the face
/// that lies in it start on it and miss it.
///
/// Flat cells look one way: those that meet the rectangle and have a corner in front of it (local z > 0). A
/// wall in the plane of the cell is seen edge-on at most and does not count.
///
/// The box is the one the rays leave: faces are rounded to float, so it is grown by the distance, a few units
/// in the last place, by which their corners stray from the exact cell (nothing for cells whose corners
/// floats hold exactly). For a turned cell, whether a touching triangle counts is up to that rounding.
std::vector<uint32_t> containedTriangles(const Scene& scene, const ViewCell& cell);

/// The same by the scene's tree: looks at the triangles near the cell only.
std::vector<uint32_t> containedTriangles(const Scene& scene, const Bvh& bvh, const ViewCell& cell);

}  // namespace sightline
