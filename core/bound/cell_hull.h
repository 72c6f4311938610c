#pragma once
#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <span>

#include "core/cell/view_cell.h"
#include "core/voxel/lattice.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {

/// A box in voxels, with its surface.
struct RealBox {
  glm::dvec3 low{0.0}, high{0.0};
};

/// A rectangle in the plane across one axis; u and v are the next two axes in the order x, y, z, x, y.
struct PlaneRect {
  double low_u = 0, high_u = 0, low_v = 0, high_v = 0;
};

/// A view cell in voxels, as far as segments from it to boxes go.
///
///     cell     plane      box           All segments from a convex cell to a convex box cross a plane
///     between
///    +----+      |                      them in a convex set; those from corner to corner cross it at this
///    |    |------|------+---+           set's corners. So the rectangle around these holds where all do.
///    |    |------|------|   |
///    +----+      |      +---+
///
/// All is rounded so that it holds what it should: the cell with its faces as floats, from which rays leave.
class CellHull {
 public:
  CellHull(const ViewCell& cell, const Lattice& lattice);

  /// Its longest side.
  double longest() const { return 2 * std::max({half_size_.x, half_size_.y, half_size_.z}); }
  /// Its two halves, cut across that side.
  std::array<CellHull, 2> halves() const;

  /// The smallest box around it, rounded outwards.
  const RealBox& box() const { return box_; }
  glm::dvec3 center() const { return 0.5 * (box_.low + box_.high); }

  /// Where the segments to the box cross the plane `at` along the axis, which lies between the cell and the
  /// box (it may touch neither).
  PlaneRect crossing(const RealBox& to, int axis, double at) const;

  /// Whether a flat cell looks to no point of the box; false for all others.
  bool isBehind(const RealBox& box) const;

  /// Whether the cell may have a point in common with the box; false only if it has none.
  bool mayMeet(const RealBox& box) const;

 private:
  CellHull() = default;
  void setCorners();

  /// Some of its corners: those with this coordinate along an axis lie in this rectangle.
  struct End {
    double at;
    PlaneRect rect;
  };

  RealBox box_;
  std::array<std::array<End, 8>, 3> ends_;  ///< along each axis
  int end_count_;                           ///< 2 of a box along the axes, 8 of a turned one
  bool flat_;
  double slack_;                    ///< more than sums of coordinates are rounded by
  std::array<glm::dvec3, 3> axes_;  ///< the cell's own
  glm::dvec3 middle_, half_size_;   ///< grown by rounding
};

}  // namespace sightline
