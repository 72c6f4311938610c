// Error analysis, u = 2^-24. clipPosition rounds the difference to the eye by u of itself, the three products
// by u each, and their two sums: a coordinate of the result errs by at most 6 u of the sum of |factor| *
// |difference|. x, y and w of a triangle's corners are compared by what cuts it, with another rounding. 2^-20
// = 16 u of the same sums, with both vectors' factors in them, leaves a factor of 2; the doubles here err by
// far less.
#include "core/draw/frustum.h"

#include <algorithm>
#include <cmath>

namespace sightline {

namespace {

constexpr double kFrustumRounding = 0x1p-20;

glm::dvec3 widened(const vec4& v) {
  return {v.x, v.y, v.z};
}

/// Least and largest of normal . (p - eye) over the box, and the size of what is added up.
struct Reach {
  double least = 0, largest = 0, size = 0;
};

Reach reachOf(const glm::dvec3& normal, const glm::dvec3& weights, const glm::dvec3& eye,
              const AxisBox& box) {
  Reach reach;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.low[axis] - eye[axis], high = box.high[axis] - eye[axis];
    const double a = normal[axis] * low, b = normal[axis] * high;
    reach.least += std::min(a, b);
    reach.largest += std::max(a, b);
    reach.size += weights[axis] * std::max(std::fabs(low), std::fabs(high));
  }
  return reach;
}

}  // namespace

Frustum::Frustum(const Camera& camera) : eye_(widened(camera.eye)) {
  const glm::dvec3 forward = widened(camera.forward);
  const glm::dvec3 sizes = glm::abs(forward);
  int count = 0;
  for (const glm::dvec3& side : {widened(camera.across), widened(camera.down)}) {
    planes_[count++] = {forward - side, 0, sizes + glm::abs(side)};
    planes_[count++] = {forward + side, 0, sizes + glm::abs(side)};
  }
  depth_ = {forward, 0, sizes};
  planes_[count] = {forward, camera.eye.w, sizes};
}

FrustumSide Frustum::sideOf(const AxisBox& box) const {
  FrustumSide side = FrustumSide::inside;
  for (const Plane& plane : planes_) {
    const Reach reach = reachOf(plane.normal, plane.rounding, eye_, box);
    const double margin = reach.size * kFrustumRounding;
    if (reach.largest < plane.offset - margin) return FrustumSide::outside;
    if (reach.least < plane.offset + margin) side = FrustumSide::meets;
  }
  return side;
}

Frustum::Distances Frustum::distancesOf(const AxisBox& box) const {
  const Reach reach = reachOf(depth_.normal, depth_.rounding, eye_, box);
  const double margin = reach.size * kFrustumRounding;
  return {reach.least - margin, reach.largest + margin};
}

}  // namespace sightline
