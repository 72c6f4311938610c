#include "core/voxel/triangle_rows.h"

#include <cmath>
#include <limits>

#include "core/voxel/exact_sign.h"

namespace sightline {
namespace {

// Of rounding in a half space's factors, rest and value together, in units of the sum of what is added: each
// of some ten operations gives at most 2^-53 of it.
constexpr double kRounding = 32 * 0x1p-53;

int signOfStep(double from, double to) {
  return (to > from) - (to < from);
}

ExactPoint pointOf(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

template <int U, int V>
void TriangleRows::addEdge(int edge, int side) {
  const glm::dvec3 &p = corners_[size_t(edge)], &q = corners_[size_t((edge + 1) % 3)];
  HalfSpace half{};
  half.u = U;
  half.v = V;
  half.edge = edge;
  half.side = side;
  half.rises[U] = -side * signOfStep(p[V], q[V]);
  half.rises[V] = side * signOfStep(p[U], q[U]);
  if (half.rises[U] == 0 || half.rises[V] == 0) return;  // along an axis: the box says the same
  half.factor[U] = -side * (q[V] - p[V]);
  half.factor[V] = side * (q[U] - p[U]);
  const glm::dvec3 size = glm::dvec3(box_.high - box_.low) + 3.0;
  half.tolerance =
      kRounding * (std::abs(half.factor[U]) + std::abs(half.factor[V])) * std::max(size[U], size[V]);
  for (const int axis : {U, V}) {
    half.corner[axis] = half.rises[axis] > 0;
    half.rest += half.factor[axis] * (double(half.corner[axis]) - (p[axis] - double(box_.low[axis])));
  }
  keep(half);
}

// Seen along the third axis, the triangle is on the inner side of each of its edges; if it is a segment, the
// square must have a corner on both sides of it.
template <int U, int V>
void TriangleRows::addEdges(int orientation) {
  if (orientation != 0) {
    for (int edge = 0; edge < 3; ++edge) addEdge<U, V>(edge, orientation);
    return;
  }
  int longest = 0;
  double length = -1;
  for (int edge = 0; edge < 3; ++edge) {
    const glm::dvec3 step = corners_[size_t((edge + 1) % 3)] - corners_[size_t(edge)];
    const double size = std::abs(step[U]) + std::abs(step[V]);
    if (size > length) {
      longest = edge;
      length = size;
    }
  }
  addEdge<U, V>(longest, 1);
  addEdge<U, V>(longest, -1);
}

void TriangleRows::prepare() {
  is_ready_ = true;
  const auto& p = corners_;
  const auto orientation = [&](int u, int v) {
    return orient2d(p[0][u], p[0][v], p[1][u], p[1][v], p[2][u], p[2][v]);
  };
  const glm::ivec3 normal(orientation(1, 2), orientation(2, 0), orientation(0, 1));
  addEdges<1, 2>(normal.x);
  addEdges<0, 2>(-normal.y);
  addEdges<0, 1>(normal.z);
  addPlane(normal);
}

// The plane has a corner of the cube on both sides of it, or on it.
void TriangleRows::addPlane(const glm::ivec3& signs) {
  if ((signs.x != 0) + (signs.y != 0) + (signs.z != 0) < 2) return;  // none, or the box says the same
  const glm::dvec3 u = corners_[1] - corners_[0], v = corners_[2] - corners_[0];
  const glm::dvec3 plus(u.y * v.z, u.z * v.x, u.x * v.y), minus(u.z * v.y, u.x * v.z, u.y * v.x);
  const glm::dvec3 normal = plus - minus, magnitude = glm::abs(plus) + glm::abs(minus);
  const glm::dvec3 size = glm::dvec3(box_.high - box_.low) + 3.0;
  for (const int side : {1, -1}) {
    HalfSpace half{};
    half.side = side;
    half.u = half.v = -1;
    half.rises = side * signs;
    half.factor = double(side) * normal;
    half.tolerance =
        kRounding * (magnitude.x + magnitude.y + magnitude.z) * std::max({size.x, size.y, size.z});
    for (int axis = 0; axis < 3; ++axis) {
      if (signs[axis] == 0) half.factor[axis] = 0;
      half.corner[axis] = half.rises[axis] > 0;
      half.rest +=
          half.factor[axis] * (double(half.corner[axis]) - (corners_[0][axis] - double(box_.low[axis])));
    }
    keep(half);
  }
}

void TriangleRows::keep(HalfSpace& half) {
  const bool is_along_x = half.rises.x == 0;
  const double factor = is_along_x ? half.factor.y : half.factor.x;
  const int rises = is_along_x ? half.rises.y : half.rises.x;
  // A factor that rounding has turned says nothing: infinity sends each row to the search.
  half.inverse = factor * rises > 0 ? 1 / factor : std::numeric_limits<double>::infinity();
  if (is_along_x) {
    yz_[size_t(count_yz_++)] = half;
  } else {
    x_[size_t(count_x_++)] = half;
  }
}

bool TriangleRows::holds(const HalfSpace& half, const glm::ivec3& voxel) const {
  const glm::dvec3 corner(voxel + half.corner);
  if (half.u < 0) {
    return half.side *
               orient3d(pointOf(corners_[0]), pointOf(corners_[1]), pointOf(corners_[2]), pointOf(corner)) >=
           0;
  }
  const glm::dvec3 &p = corners_[size_t(half.edge)], &q = corners_[size_t((half.edge + 1) % 3)];
  return half.side * orient2d(p[half.u], p[half.v], q[half.u], q[half.v], corner[half.u], corner[half.v]) >=
         0;
}

// A half space holds from one voxel of the row on, or up to one.
void TriangleRows::search(const HalfSpace& half, glm::ivec3 at, int axis, int& low, int& high, int from,
                          int to) const {
  const bool rises = half.rises[axis] > 0;
  while (from < to) {  // rises: the first that holds is in from .. to; else the first that does not
    const int middle = from + (to - from) / 2;
    at[axis] = middle;
    if (holds(half, at) == rises) {
      to = middle;
    } else {
      from = middle + 1;
    }
  }
  (rises ? low : high) = rises ? from : from - 1;
}

}  // namespace sightline
