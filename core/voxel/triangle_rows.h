#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/voxel/voxel_box.h"

namespace sightline {

/// The smallest whole number that is not below the value; of one beyond 2^30, some number beyond 2^29.
inline int ceiling(double value) {
  const int whole = int(std::clamp(value, -0x1p30, 0x1p30));
  return whole + (double(whole) < value);
}

/// The smallest box of voxels that holds all whose closed cubes meet the triangle.
inline VoxelBox voxelsAround(const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec3 low = glm::min(corners[0], glm::min(corners[1], corners[2]));
  const glm::dvec3 high = glm::max(corners[0], glm::max(corners[1], corners[2]));
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = ceiling(low[axis]) - 1;  // closed: cube i meets what is at i + 1
    box.high[axis] = -ceiling(-high[axis]);
  }
  return box;
}

/// The voxels whose closed cubes a closed triangle has a point in common with, row by row along x: exactly
/// these, whatever the triangle's size and shape (a segment or a point too).
///
/// By separating axes, a cube and a triangle are apart if one of these lies between them: a face of the cube,
/// the triangle's plane, or a plane along x, y or z through an edge. Each of the last two kinds holds for all
/// voxels of a row from one on, or up to one, so that a row's voxels are a run. Its ends come from doubles
/// with a bound on their error, and only where the bound leaves more than one answer from exact arithmetic
/// (core/voxel/exact_sign.h).
///
/// Based on: M. Schwarz, H.-P. Seidel, Fast Parallel Surface and Solid Voxelization on GPUs, 2010, section 3:
/// its edge functions; solved for the row here, not evaluated for each voxel, and exact.
class TriangleRows {
 public:
  /// Corners in voxels, of a magnitude of at most 2^30.
  explicit TriangleRows(const std::array<glm::dvec3, 3>& corners)
      : corners_(corners), box_(voxelsAround(corners)) {}

  /// The smallest box of voxels that holds them all.
  const VoxelBox& box() const { return box_; }

  /// Calls visit(y, z, first, last) for the rows in the box that have such voxels, z and then y ascending.
  template <typename Visit>
  void visit(const VoxelBox& within, Visit&& visit) {
    const VoxelBox part = overlapOf(within, box_);
    if (part.low.x > part.high.x || part.low.y > part.high.y || part.low.z > part.high.z) return;
    if (isStraight()) {
      for (int z = part.low.z; z <= part.high.z; ++z) {
        for (int y = part.low.y; y <= part.high.y; ++y) visit(y, z, part.low.x, part.high.x);
      }
      return;
    }
    if (!is_ready_) prepare();
    for (int z = part.low.z; z <= part.high.z; ++z) {
      int low_y = part.low.y, high_y = part.high.y;
      for (int i = 0; i < count_yz_; ++i) narrow(yz_[size_t(i)], {0, 0, z}, 1, low_y, high_y);
      for (int y = low_y; y <= high_y; ++y) {
        int low_x = part.low.x, high_x = part.high.x;
        for (int i = 0; i < count_x_ && low_x <= high_x; ++i)
          narrow(x_[size_t(i)], {0, y, z}, 0, low_x, high_x);
        if (low_x <= high_x) visit(y, z, low_x, high_x);
      }
    }
  }

 private:
  /// What a voxel's corner nearest to the inner side of a plane is asked: factor . (voxel - base) + rest >=
  /// 0, in doubles that are off by `tolerance` at most.
  struct HalfSpace {
    glm::dvec3 factor;
    double rest, tolerance;
    double inverse;     ///< of factor.x, or where that is 0 of factor.y
    glm::ivec3 rises;   ///< exact signs of factor
    glm::ivec3 corner;  ///< of the voxel: 0 or 1 along each axis
    int side;           ///< sign of the orientation that is on the inner side
    int u, v;           ///< axes of the plane in which the edge is; -1: the triangle's plane
    int edge;           ///< from this corner of the triangle to the next
  };

  /// Whether the box's voxels all meet the triangle: it is within one layer of voxels along two axes.
  bool isStraight() const {
    const glm::ivec3 size = box_.high - box_.low;
    return (size.x == 0) + (size.y == 0) + (size.z == 0) >= 2;
  }
  void prepare();
  template <int U, int V>
  void addEdge(int edge, int side);
  template <int U, int V>
  void addEdges(int orientation);
  void addPlane(const glm::ivec3& signs);
  void keep(HalfSpace& half);
  bool holds(const HalfSpace& half, const glm::ivec3& voxel) const;
  /// By halves, where the half space begins or ends to hold: in from .. to.
  void search(const HalfSpace& half, glm::ivec3 at, int axis, int& low, int& high, int from, int to) const;

  /// Moves the run's one end to where the half space begins.
  void narrow(const HalfSpace& half, const glm::ivec3& at, int axis, int& low, int& high) const {
    if (low > high) return;
    double rest = half.rest + half.factor.z * double(at.z - box_.low.z);
    if (axis == 0) rest += half.factor.y * double(at.y - box_.low.y);
    const double inverse = half.inverse;
    const double end = -rest * inverse, reach = half.tolerance * std::abs(inverse);
    const int base = box_.low[axis];
    const double from = double(low - base), to = double(high - base);
    if (!(reach < 0x1p30)) return search(half, at, axis, low, high, low, high + 1);
    if (half.rises[axis] > 0) {
      if (end + reach <= from) return;
      if (end - reach > to) {
        low = high + 1;
        return;
      }
      const int first = ceiling(end - reach);
      if (end - reach > from && end + reach <= double(first)) {
        low = base + first;
        return;
      }
    } else {
      if (end - reach >= to) return;
      if (end + reach < from) {
        low = high + 1;
        return;
      }
      const int last = -ceiling(-(end + reach));
      if (end + reach < to && end - reach >= double(last)) {
        high = base + last;
        return;
      }
    }
    const bool rises = half.rises[axis] > 0;
    const int first = rises ? ceiling(end - reach) : -ceiling(-(end - reach)) + 1;
    const int last = rises ? ceiling(end + reach) : -ceiling(-(end + reach)) + 1;
    search(half, at, axis, low, high, std::max(low, base + first), std::min(high + 1, base + last));
  }

  std::array<glm::dvec3, 3> corners_;
  VoxelBox box_;
  bool is_ready_ = false;
  int count_yz_ = 0, count_x_ = 0;
  // Not set before prepare(): most triangles of fine scenes need none.
  std::array<HalfSpace, 5> yz_;  ///< of edges along x (3, or 2) and of a plane along x (2)
  std::array<HalfSpace, 8> x_;   ///< of edges along z (3) and y (3), and of the plane (2)
};

}  // namespace sightline
