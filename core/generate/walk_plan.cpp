#include "core/generate/walk_plan.h"

#include <cmath>

#include "core/cell/rotation.h"

namespace sightline {
namespace {

constexpr double kLookAhead = 10;      // metres
constexpr double kDegreesOfAKey = 45;  // looks turn by at most so much from key to key
constexpr double kOutOfAll = 1.06;     // extents up and back: a ball of half its diagonal fits in 60 degrees

}  // namespace

uint32_t WalkPlan::frameAt(double share) const {
  return uint32_t(std::floor(share * double(frames_ - 1) + 0.5));
}

void WalkPlan::key(double share, const glm::dvec3& eye, const glm::dvec3& look) {
  const uint32_t frame = frameAt(share);
  if (!path_.keys.empty() && path_.keys.back().frame >= frame) return;
  path_.keys.push_back({frame, {eye, look}});
}

void WalkPlan::cut(double share, const glm::dvec3& eye, const glm::dvec3& look) {
  path_.cuts.push_back(frameAt(share));
  path_.keys.push_back({frameAt(share), {eye, look}});
}

void WalkPlan::turn(double from, double to, const glm::dvec3& eye, double from_heading, double to_heading) {
  const double keys = std::ceil(std::fabs(to_heading - from_heading) / kDegreesOfAKey);
  for (double k = 0; k <= keys; ++k) {
    const CosSin at = cosSinDegrees(from_heading + (to_heading - from_heading) * (k / keys));
    key(from + (to - from) * (k / keys), eye, eye + kLookAhead * glm::dvec3(at.sine, 0, at.cosine));
  }
}

void WalkPlan::seeAll(const glm::dvec3& middle, double extent, const glm::dvec3& away) {
  key(1, middle + kOutOfAll * extent * (away + glm::dvec3(0, 1, 0)), middle);
}

}  // namespace sightline
