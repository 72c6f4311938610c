#include "core/voxel/separating_rows.h"

#include <algorithm>
#include <span>

#include "core/voxel/exact_sign.h"

namespace sightline {
namespace {

constexpr AxisSigns kThroughFaces[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr AxisSigns kDiagonals[] = {{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};

RealPoint realOf(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

ExactPoint exactOf(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

ExactPoint exactOf(const AxisSigns& d) {
  return {double(d.x), double(d.y), double(d.z)};
}

// Sign of u (p - q) + v (r - s) with u and v of -1, 0 and 1.
int signOfSteps(int u, double p, double q, int v, double r, double s) {
  return signOfSum(u * p, -u * q, v * r, -v * s);
}

// What the shift by (e, e^2, e^3) makes of a value that is zero.
int signOfShift(const AxisSigns& rises) {
  return rises.x != 0 ? rises.x : rises.y != 0 ? rises.y : rises.z;
}

// Which of a family's loops asks a half space: 0 z's, 1 y's, 2 x's.
int loopOf(const AxisSigns& rises) {
  return rises.x != 0 ? 2 : rises.y != 0 ? 1 : 0;
}

}  // namespace

SeparatingRows::SeparatingRows(const std::array<glm::dvec3, 3>& corners, Separation separation)
    : corners_(corners), separation_(separation), box_(TriangleRows(corners).box()) {}

void SeparatingRows::prepare() {
  is_ready_ = true;
  const auto& p = corners_;
  const RoundedVector normal = triangleNormal(realOf(p[0]), realOf(p[1]), realOf(p[2]));
  AxisSigns signs = roundedSigns(normal);
  const auto orientation = [&](int u, int v) {
    return orient2d(p[0][u], p[0][v], p[1][u], p[1][v], p[2][u], p[2][v]);
  };
  if (signs.x == kOpenSign) signs.x = orientation(1, 2);
  if (signs.y == kOpenSign) signs.y = orientation(2, 0);
  if (signs.z == kOpenSign) signs.z = orientation(0, 1);
  if (signs.x == 0 && signs.y == 0 && signs.z == 0) return;
  for (const AxisSigns& along : separation_ == Separation::k6 ? std::span<const AxisSigns>(kThroughFaces)
                                                              : std::span<const AxisSigns>(kDiagonals)) {
    if (makeFamily(along, normal, signs, families_[size_t(count_)])) ++count_;
  }
}

bool SeparatingRows::makeFamily(const AxisSigns& along, const RoundedVector& normal, const AxisSigns& signs,
                                Family& family) const {
  int side = roundedSignAlong(normal, along);
  if (side == kOpenSign)
    side = orientAlong(exactOf(along), exactOf(corners_[1]), exactOf(corners_[2]), exactOf(corners_[0]));
  if (side == 0) return false;  // seen along its own plane: no shifted line meets it
  family.along = along;
  std::array<Plane, 5>& planes = family.planes;
  for (int edge = 0; edge < 3; ++edge) planes[size_t(edge)] = edgePlane(along, edge, side);
  const glm::dvec3 size(box_.high - box_.low);
  for (const int end : {0, 1}) {
    Plane& plane = planes[size_t(3 + end)];
    plane.edge = -1;
    plane.side = end == 0 ? -side : side;
    plane.target = 0.5 + (end - 0.5) * glm::dvec3(along.x, along.y, along.z);
    plane.half =
        voxelHalf(normal, signs, plane.side, realOf(plane.target - (corners_[0] - glm::dvec3(box_.low))),
                  std::max({size.x, size.y, size.z}) + 3);
  }
  std::stable_sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) {
    return loopOf(a.half.rises) < loopOf(b.half.rises);
  });
  family.first_y = family.first_x = 0;
  for (Plane& plane : planes) {
    const int loop = loopOf(plane.half.rises);
    family.first_y += loop < 1;
    family.first_x += loop < 2;
    plane.inverse = {inverseOf(plane.half.factor.x, plane.half.rises.x),
                     inverseOf(plane.half.factor.y, plane.half.rises.y),
                     inverseOf(plane.half.factor.z, plane.half.rises.z)};
  }
  return true;
}

SeparatingRows::Plane SeparatingRows::edgePlane(const AxisSigns& d, int edge, int side) const {
  const glm::dvec3 &p = corners_[size_t(edge)], &q = corners_[size_t((edge + 1) % 3)];
  const RoundedVector gradient = edgeGradient(realOf(p), realOf(q), d);
  AxisSigns signs = roundedSigns(gradient);
  if (signs.x == kOpenSign) signs.x = signOfSteps(d.z, p.y, q.y, -d.y, p.z, q.z);
  if (signs.y == kOpenSign) signs.y = signOfSteps(d.x, p.z, q.z, -d.z, p.x, q.x);
  if (signs.z == kOpenSign) signs.z = signOfSteps(d.y, p.x, q.x, -d.x, p.y, q.y);
  const glm::dvec3 size(box_.high - box_.low);
  Plane plane;
  plane.edge = edge;
  plane.side = side;
  plane.target = glm::dvec3(0.5);
  plane.half = voxelHalf(gradient, signs, side, realOf(plane.target - (p - glm::dvec3(box_.low))),
                         std::max({size.x, size.y, size.z}) + 3);
  return plane;
}

bool SeparatingRows::holds(const Plane& plane, const AxisSigns& along, const glm::ivec3& voxel) const {
  const ExactPoint target = exactOf(glm::dvec3(voxel) + plane.target);
  const int sign = plane.edge < 0
                       ? orient3d(exactOf(corners_[0]), exactOf(corners_[1]), exactOf(corners_[2]), target)
                       : orientAlong(exactOf(along), exactOf(corners_[size_t(plane.edge)]),
                                     exactOf(corners_[size_t((plane.edge + 1) % 3)]), target);
  return (sign != 0 ? plane.side * sign : signOfShift(plane.half.rises)) > 0;
}

// By halves: a half space holds from one voxel of the row on, or up to one.
void SeparatingRows::search(const Family& family, const Plane& plane, glm::ivec3 at, int axis, int& low,
                            int& high) const {
  const AxisSigns& signs = plane.half.rises;
  const bool rises = (axis == 0 ? signs.x : axis == 1 ? signs.y : signs.z) > 0;
  int from = low, to = high + 1;  // the first that holds, or if it falls the first that does not
  while (from < to) {
    const int middle = from + (to - from) / 2;
    at[axis] = middle;
    if (holds(plane, family.along, at) == rises) {
      to = middle;
    } else {
      from = middle + 1;
    }
  }
  (rises ? low : high) = rises ? from : from - 1;
}

}  // namespace sightline
