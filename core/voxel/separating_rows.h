#pragma once
#include <array>
#include <glm/glm.hpp>

#include "core/shared/voxel_planes.h"
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
    std::array<double, 2> inverse{};  ///< of half.factor's x and y
    int source = 0;                   ///< of core/shared/voxel_planes.h
    int side = 1;                     ///< sign of the orientation that is on the inner side
  };
  /// Of the targets along one direction. Half spaces that a single coordinate decides are in its box.
  struct Family {
    AxisSigns along{};
    PlaceBox box{};  ///< from the triangle's box on
    std::array<Plane, 5> planes;
    int first_x = 0, count = 0;  ///< from first_x on x has a part in them
  };

  void prepare();
  bool makeFamily(const AxisSigns& along, Family& family) const;
  bool addPlane(int edge, const RoundedVector& gradient, const AxisSigns& signs, int side,
                const AxisSigns& halves, Family& family) const;
  AxisSigns signsOfEdge(const RoundedVector& gradient, int edge, const AxisSigns& along) const;
  bool holds(const Family& family, const Plane& plane, const glm::ivec3& place) const;
  void search(const Family& family, const Plane& plane, glm::ivec3 at, int axis, double end, double reach,
              int& low, int& high) const;

  // Places are counted from the triangle's box on.
  void narrow(const Family& family, const Plane& plane, const glm::ivec3& at, int axis, int& low,
              int& high) const {
    if (low > high) return;
    const VoxelHalf& half = plane.half;
    double rest = half.rest + half.factor.z * at.z;
    if (axis == 0) rest += half.factor.y * at.y;
    const double inverse = plane.inverse[size_t(axis)];
    const VoxelRun run =
        narrowRun({low, high, false}, rest, inverse, half.tolerance, axis == 0 ? half.rises.x : half.rises.y);
    if (run.open)
      return search(family, plane, at, axis, -rest * inverse, half.tolerance * std::abs(inverse), low, high);
    low = run.low;
    high = run.high;
  }

  template <typename Visit>
  void visitFamily(const Family& family, const VoxelBox& part, Visit& visit) const {
    const PlaceBox& box = family.box;
    const glm::ivec3 low = glm::max(glm::ivec3(box.low.x, box.low.y, box.low.z), part.low - box_.low);
    const glm::ivec3 high = glm::min(glm::ivec3(box.high.x, box.high.y, box.high.z), part.high - box_.low);
    for (int z = low.z; z <= high.z; ++z) {
      int low_y = low.y, high_y = high.y;
      for (int i = 0; i < family.first_x; ++i)
        narrow(family, family.planes[size_t(i)], {0, 0, z}, 1, low_y, high_y);
      for (int y = low_y; y <= high_y; ++y) {
        int low_x = low.x, high_x = high.x;
        for (int i = family.first_x; i < family.count && low_x <= high_x; ++i)
          narrow(family, family.planes[size_t(i)], {0, y, z}, 0, low_x, high_x);
        if (low_x <= high_x) visit(y + box_.low.y, z + box_.low.z, low_x + box_.low.x, high_x + box_.low.x);
      }
    }
  }

  std::array<glm::dvec3, 3> corners_;
  Separation separation_;
  VoxelBox box_;
  bool is_ready_ = false;
  VoxelTriangle triangle_{};  ///< as seen from its box
  int count_ = 0;
  std::array<Family, 4> families_;
};

}  // namespace sightline
