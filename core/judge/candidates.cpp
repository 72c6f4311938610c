#include "core/judge/candidates.h"

#include <cmath>

namespace sightline {
namespace {

/// By how much boxes grow, a share of the reach.
constexpr double kBoxGrowth = 0x1p-22;
/// Stands for 1 / 0: a plane is never at the grown distance 0, so no product is NaN.
constexpr double kParallel = 1e300;

}  // namespace

CandidateWalk::CandidateWalk(const Bvh& bvh)
    : bvh_(bvh), reach_(glm::max(maxAbs(glm::dvec3(bvh.low)), maxAbs(glm::dvec3(bvh.high)))) {}

double CandidateWalk::growth(const JudgeRay& ray, double padding) const {
  return padding + kBoxGrowth * (reach_ + maxAbs(ray.origin));
}

CandidateWalk::Slabs CandidateWalk::slabsIn(const InstanceRecord& instance, const JudgeRay& ray,
                                            double growth) {
  const Placement& place = instance.place;
  const glm::dmat3 inverse =
      glm::inverse(glm::dmat3(glm::dvec3(place.x), glm::dvec3(place.y), glm::dvec3(place.z)));
  JudgeRay inner = ray;
  inner.origin = inverse * (ray.origin - glm::dvec3(place.origin));
  inner.direction = inverse * ray.direction;
  const glm::dvec3 stretch = glm::abs(inverse[0]) + glm::abs(inverse[1]) + glm::abs(inverse[2]);
  return slabs(inner, stretch * growth + glm::dvec3(instance.padding));
}

CandidateWalk::Slabs CandidateWalk::slabs(const JudgeRay& ray, const glm::dvec3& growth) {
  Slabs result;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis];
    result.inverse[axis] = d == 0 ? kParallel : 1 / d;
    result.low_shift[axis] = -growth[axis] - ray.origin[axis];
    result.high_shift[axis] = growth[axis] - ray.origin[axis];
  }
  return result;
}

void CandidateWalk::meet(const BvhNode8& node, const Slabs& slabs, Ranges& ranges) {
  const float* lows[3] = {node.low_x, node.low_y, node.low_z};
  const float* highs[3] = {node.high_x, node.high_y, node.high_z};
  for (int i = 0; i < 8; ++i) {
    ranges.near[i] = 0;
    ranges.far[i] = HUGE_VAL;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = slabs.inverse[axis];
    const bool back = inverse < 0;
    const float* first = back ? highs[axis] : lows[axis];
    const float* last = back ? lows[axis] : highs[axis];
    const double first_shift = back ? slabs.high_shift[axis] : slabs.low_shift[axis];
    const double last_shift = back ? slabs.low_shift[axis] : slabs.high_shift[axis];
    for (int i = 0; i < 8; ++i) {  // empty slots: near becomes +inf
      const double near = (double(first[i]) + first_shift) * inverse;
      const double far = (double(last[i]) + last_shift) * inverse;
      ranges.near[i] = near > ranges.near[i] ? near : ranges.near[i];
      ranges.far[i] = far < ranges.far[i] ? far : ranges.far[i];
    }
  }
}

}  // namespace sightline
