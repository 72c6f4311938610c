#pragma once
#include <vector>

#include "core/cell/view_cell.h"
#include "core/scene/scene.h"

namespace sightline {

/// Six flat cells, the sides of a box around these bounds, which look into it: outside-x, outside+x,
/// outside-y,
/// ... What they see is what can be seen from anywhere outside of the bounds: the line from a triangle to a
/// viewer there, drawn on beyond the viewer, comes back to no triangle, since the bounds are convex, and
/// leaves the box through one of its sides.
///
///      +--outside+y--+
///      |  +-------+  |   the margin is a hundredth of the bounds' diagonal, but no less than 64 steps of a
///      float
///  -x  |  | scene |  |   at the farthest coordinate, so that no side touches a triangle
///      |  +-------+  | +x
///      +--outside-y--+
std::vector<ViewCell> outsideCells(const Bounds& bounds);

}  // namespace sightline
