#pragma once
#include <optional>

#include "bvh/bvh.h"
#include "core/cell/cell_frame.h"
#include "core/scene/scene.h"

namespace sightline {

/// How far the sides of a box come in, along its local axes.
struct SideInsets {
  glm::dvec3 low{0.0}, high{0.0};
  bool none() const { return low == glm::dvec3(0.0) && high == glm::dvec3(0.0); }
};

/// How far which sides of the box must come in, each at most by `limit` of its axis, for every triangle to be
/// `margin` or more away from it (in the largest of the local axes' distances). Nothing if some triangle
/// reaches in deeper than that. Sides with nothing near them stay, so boxes of a grid go on meeting each
/// other where there is room.
///
/// A triangle in a corner can be cleared by either of several sides: the one that has the least to go is
/// taken, and of the triangles those first that leave the least choice. margin is above 0 and well above the
/// spacing of floats there, limit above margin. bvh is of this scene. The result is the same on every
/// machine.
std::optional<SideInsets> insetsToClear(const Scene& scene, const Bvh& bvh, const CellFrame& box,
                                        double margin, const glm::dvec3& limit);

/// The cell with its sides come in.
ViewCell withInsets(ViewCell cell, const SideInsets& insets);

/// The margin of cells whose smallest extent is `extent`, unless another is asked for: a hundredth of it, yet
/// at least the spacing of floats at the scene's farthest coordinate, to which the corners of cells are
/// rounded, and at most an eighth of it: of cells that small so far out, little more than the rounding is
/// left.
double defaultMargin(const Bounds& bounds, double extent);

/// Throws Error (wrong usage) that begins with `what` unless `margin` is 0, or above it and at most an eighth
/// of `extent`: more would leave nothing of the cells.
void checkMargin(double margin, double extent, const std::string& what);

}  // namespace sightline
