#include "core/voxel/separating_rows.h"

#include <algorithm>
#include <cmath>
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

// Whether rounding leaves no doubt that the half space has no voxel in common with the box.
bool missesBox(const VoxelHalf& half, const PlaceBox& box) {
  const auto most = [](double factor, int low, int high) { return std::max(factor * low, factor * high); };
  return half.rest + most(half.factor.x, box.low.x, box.high.x) + most(half.factor.y, box.low.y, box.high.y) +
             most(half.factor.z, box.low.z, box.high.z) <
         -half.tolerance;
}

}  // namespace

SeparatingRows::SeparatingRows(const std::array<glm::dvec3, 3>& corners, Separation separation)
    : corners_(corners), separation_(separation), box_(voxelsAround(corners)) {}

void SeparatingRows::prepare() {
  is_ready_ = true;
  const auto& p = corners_;
  const glm::ivec3 extent = box_.high - box_.low;
  VoxelTriangle& t = triangle_;
  t.a = realOf(p[0]);
  t.b = realOf(p[1]);
  t.c = realOf(p[2]);
  t.base = {box_.low.x, box_.low.y, box_.low.z};
  t.box = {{0, 0, 0}, {extent.x, extent.y, extent.z}};
  t.size = std::max({extent.x, extent.y, extent.z}) + 3;
  t.normal = triangleNormal(t.a, t.b, t.c);
  t.signs = normalSigns(t.normal, t.a, t.b, t.c);
  const auto orientation = [&](int u, int v) {
    return orient2d(p[0][u], p[0][v], p[1][u], p[1][v], p[2][u], p[2][v]);
  };
  if (t.signs.x == kOpenSign) t.signs.x = orientation(1, 2);
  if (t.signs.y == kOpenSign) t.signs.y = orientation(2, 0);
  if (t.signs.z == kOpenSign) t.signs.z = orientation(0, 1);
  if (countOf(t.signs) == 0) return;
  for (const AxisSigns& along : separation_ == Separation::k6 ? std::span<const AxisSigns>(kThroughFaces)
                                                              : std::span<const AxisSigns>(kDiagonals)) {
    if (makeFamily(along, families_[size_t(count_)])) ++count_;
  }
}

// Whether it may have a voxel at all.
bool SeparatingRows::makeFamily(const AxisSigns& along, Family& family) const {
  int side = signAlong(triangle_, along);
  if (side == kOpenSign)
    side = orientAlong(exactOf(along), exactOf(corners_[1]), exactOf(corners_[2]), exactOf(corners_[0]));
  if (side == 0) return false;  // seen along its own plane: no shifted line meets it
  family.along = along;
  family.box = triangle_.box;
  family.count = 0;
  for (const int end : {-1, 1}) {
    const AxisSigns halves{1 + end * along.x, 1 + end * along.y, 1 + end * along.z};
    if (!addPlane(3, triangle_.normal, triangle_.signs, end * side, halves, family)) return false;
  }
  for (int edge = 0; edge < 3; ++edge) {
    const RoundedVector gradient =
        edgeGradient(cornerOf(triangle_, edge), cornerOf(triangle_, edge == 2 ? 0 : edge + 1), along);
    if (!addPlane(edge, gradient, signsOfEdge(gradient, edge, along), side, {1, 1, 1}, family)) return false;
  }
  const auto first_x = std::stable_partition(family.planes.begin(), family.planes.begin() + family.count,
                                             [](const Plane& plane) { return plane.half.rises.x == 0; });
  family.first_x = int(first_x - family.planes.begin());
  return true;
}

// Whether it leaves a voxel, as far as rounding tells.
bool SeparatingRows::addPlane(int edge, const RoundedVector& gradient, const AxisSigns& signs, int side,
                              const AxisSigns& halves, Family& family) const {
  const RealPoint p = cornerOf(triangle_, edge == 3 ? 0 : edge);
  if (countOf(signs) == 1) {
    const AxisSigns rises{side * signs.x, side * signs.y, side * signs.z};
    family.box = cutBox(family.box, rises, p, halves, triangle_.base);
    const PlaceBox& box = family.box;
    return box.low.x <= box.high.x && box.low.y <= box.high.y && box.low.z <= box.high.z;
  }
  Plane& plane = family.planes[size_t(family.count++)];
  plane.half = voxelHalf(gradient, signs, side, fromCorner(halves, p, triangle_.base), triangle_.size);
  if (missesBox(plane.half, family.box)) return false;
  plane.source = sourceOf(edge, 0, halves);
  plane.side = side;
  plane.inverse = {inverseOf(plane.half.factor.x, plane.half.rises.x),
                   inverseOf(plane.half.factor.y, plane.half.rises.y)};
  return true;
}

AxisSigns SeparatingRows::signsOfEdge(const RoundedVector& gradient, int edge, const AxisSigns& d) const {
  const glm::dvec3 &p = corners_[size_t(edge)], &q = corners_[size_t((edge + 1) % 3)];
  AxisSigns signs = edgeSigns(gradient, realOf(p), realOf(q));
  if (signs.x == kOpenSign) signs.x = signOfSteps(d.z, p.y, q.y, -d.y, p.z, q.z);
  if (signs.y == kOpenSign) signs.y = signOfSteps(d.x, p.z, q.z, -d.z, p.x, q.x);
  if (signs.z == kOpenSign) signs.z = signOfSteps(d.y, p.x, q.x, -d.x, p.y, q.y);
  return signs;
}

bool SeparatingRows::holds(const Family& family, const Plane& plane, const glm::ivec3& place) const {
  int sign =
      exactSignAt(triangle_, plane.source, false, family.along, plane.half.rises, place.x, place.y, place.z);
  if (sign == kOpenSign) {
    const int edge = plane.source & 3;
    const glm::dvec3 halves((plane.source >> 4) & 3, (plane.source >> 6) & 3, (plane.source >> 8) & 3);
    const ExactPoint target = exactOf(glm::dvec3(box_.low + place) + 0.5 * halves);
    sign = plane.side *
           (edge == 3 ? orient3d(exactOf(corners_[0]), exactOf(corners_[1]), exactOf(corners_[2]), target)
                      : orientAlong(exactOf(family.along), exactOf(corners_[size_t(edge)]),
                                    exactOf(corners_[size_t((edge + 1) % 3)]), target));
  }
  return (sign != 0 ? sign : signOfShift(plane.half.rises)) > 0;
}

// By halves, among the voxels that rounding leaves open: a half space holds from one voxel of the row on, or
// up to one.
void SeparatingRows::search(const Family& family, const Plane& plane, glm::ivec3 at, int axis, double end,
                            double reach, int& low, int& high) const {
  const bool rises = (axis == 0 ? plane.half.rises.x : plane.half.rises.y) > 0;
  // The first that holds, or if it falls the first that does not.
  int from = low, to = high + 1;
  if (reach < 0x1p30) {
    from = int(std::clamp(std::floor(end - reach), double(low), double(high + 1)));
    to = int(std::clamp(std::ceil(end + reach) + 1, double(low), double(high + 1)));
  }
  while (from < to) {
    const int middle = from + (to - from) / 2;
    at[axis] = middle;
    if (holds(family, plane, at) == rises) {
      to = middle;
    } else {
      from = middle + 1;
    }
  }
  (rises ? low : high) = rises ? from : from - 1;
}

}  // namespace sightline
