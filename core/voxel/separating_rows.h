#pragma once
#include <array>
#include <glm/glm.hpp>

#include "core/shared/voxel_half.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {

/// Which voxels stand for a surface.
enum class Separation {
  kConservative,  ///< all that meet it
  k26,  ///< of those the ones that keep its sides apart for paths from voxel to voxel by face, edge or corner
  k6,   ///< ... for paths by faces, as view rays are: the fewest
};

/// The voxels that a triangle gives to the 26- or 6-separating set of a surface: those of whose diagonals it
/// meets one (26), or one of the three segments through the voxel's centre from face to face (6). Centres of
/// neighbours are joined by halves of such segments, so that no path crosses a closed surface between voxels
/// that are not in the set.
///
///      26: +-------+      6: +---|---+
///          | \   / |         |   |   |       a target belongs to the voxel, and those of
///          |   X   |         ----+----       neighbours that follow each other are a line
///          | /   \ |         |   |   |
///          +-------+         +---|---+
///
/// A target that passes through an edge or a corner of the triangle must be met by one of the surface's parts
/// there, and not by none of them, nor may a crossing at the end of a target be in neither voxel. So all
/// targets are moved by (e, e^2, e^3) with an e > 0 smaller than any number: then no such case is left, and
/// the set depends on the surface alone, not on how triangles part it. A triangle without area gives none.
///
/// On a family of parallel targets these voxels are where five half spaces hold: on the inner side of three
/// edges as seen along the target, one end on one side of the plane, and the other on the other. Rows are
/// found as in TriangleRows.
///
/// Based on: S. Laine, A Topological Approach to Voxelization, 2013 (the targets); H. Edelsbrunner, E.
/// Muecke, Simulation of Simplicity, 1990 (the shift).
class SeparatingRows {
 public:
  /// Corners in voxels, of a magnitude of at most 2^30. separation: k26 or k6.
  SeparatingRows(const std::array<glm::dvec3, 3>& corners, Separation separation);

  /// Calls visit(y, z, first, last) for rows of such voxels in the box; a voxel may come several times.
  template <typename Visit>
  void visit(const VoxelBox& within, Visit&& visit) {
    const VoxelBox part = overlapOf(within, box_);
    if (part.low.x > part.high.x || part.low.y > part.high.y || part.low.z > part.high.z) return;
    if (!is_ready_) prepare();
    for (int i = 0; i < count_; ++i) visitFamily(families_[size_t(i)], part, visit);
  }

 private:
  /// Beyond the numbers of VoxelHalf: what exact arithmetic is asked.
  struct Plane {
    VoxelHalf half;
    std::array<double, 3> inverse{};  ///< of half.factor
    int side = 1;                     ///< sign of the orientation that is on the inner side
    int edge = -1;                    ///< from this corner of the triangle to the next; -1: its plane
    glm::dvec3 target{0.0};           ///< the point of the target, from the voxel's lowest corner
  };
  /// Of the targets along one direction.
  struct Family {
    AxisSigns along;
    std::array<Plane, 5> planes;  ///< first those that only z decides, then those without x, then the others
    int first_y = 0, first_x = 0;
  };

  void prepare();
  bool makeFamily(const AxisSigns& along, const RoundedVector& normal, const AxisSigns& signs,
                  Family& family) const;
  Plane edgePlane(const AxisSigns& along, int edge, int side) const;
  bool holds(const Plane& plane, const AxisSigns& along, const glm::ivec3& voxel) const;
  void search(const Family& family, const Plane& plane, glm::ivec3 at, int axis, int& low, int& high) const;

  void narrow(const Family& family, const Plane& plane, const glm::ivec3& at, int axis, int& low,
              int& high) const {
    if (low > high) return;
    const VoxelHalf& half = plane.half;
    double rest = half.rest;
    if (axis < 2) rest += half.factor.z * double(at.z - box_.low.z);
    if (axis < 1) rest += half.factor.y * double(at.y - box_.low.y);
    const int base = box_.low[axis], rises = axis == 0   ? half.rises.x
                                             : axis == 1 ? half.rises.y
                                                         : half.rises.z;
    const VoxelRun run =
        narrowRun({low - base, high - base, false}, rest, plane.inverse[size_t(axis)], half.tolerance, rises);
    if (run.open) return search(family, plane, at, axis, low, high);
    low = base + run.low;
    high = base + run.high;
  }

  template <typename Visit>
  void visitFamily(const Family& family, const VoxelBox& part, Visit& visit) const {
    int low_z = part.low.z, high_z = part.high.z;
    for (int i = 0; i < family.first_y; ++i)
      narrow(family, family.planes[size_t(i)], {0, 0, 0}, 2, low_z, high_z);
    for (int z = low_z; z <= high_z; ++z) {
      int low_y = part.low.y, high_y = part.high.y;
      for (int i = family.first_y; i < family.first_x; ++i)
        narrow(family, family.planes[size_t(i)], {0, 0, z}, 1, low_y, high_y);
      for (int y = low_y; y <= high_y; ++y) {
        int low_x = part.low.x, high_x = part.high.x;
        for (int i = family.first_x; i < 5 && low_x <= high_x; ++i)
          narrow(family, family.planes[size_t(i)], {0, y, z}, 0, low_x, high_x);
        if (low_x <= high_x) visit(y, z, low_x, high_x);
      }
    }
  }

  std::array<glm::dvec3, 3> corners_;
  Separation separation_;
  VoxelBox box_;
  bool is_ready_ = false;
  int count_ = 0;
  std::array<Family, 4> families_;
};

}  // namespace sightline
