#include "core/draw/box_guard.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sightline {

namespace {

constexpr double kPlaceRounding = 0x1p-20;
constexpr double kDepthRounding = 0x1p-20;
constexpr double kSnappedPixels = 1.0 / 128;

double lengthOf(const vec4& v) {
  return std::sqrt((double(v.x) * v.x + double(v.y) * v.y) + double(v.z) * v.z);
}

/// The next greater float; infinity stays. Not std::nextafter, which is called for six sides of every box.
float nextAbove(float value) {
  if (value == 0) return 0x1p-149f;
  if (std::isinf(value)) return value;
  const auto bits = std::bit_cast<int32_t>(value);
  return std::bit_cast<float>(bits >= 0 ? bits + 1 : bits - 1);
}

}  // namespace

BoxGuard::BoxGuard(const Camera& camera)
    : frustum_(camera), eye_(camera.eye.x, camera.eye.y, camera.eye.z), near_(camera.eye.w) {
  // At distance d the image is 2 d / |across| wide.
  pixel_ = kSnappedPixels * std::max(2 / (lengthOf(camera.across) * camera.size.x),
                                     2 / (lengthOf(camera.down) * camera.size.y));
}

std::optional<AxisBox> BoxGuard::grown(const AxisBox& box) const {
  const Frustum::Distances distances = frustum_.distancesOf(box);
  if (!(distances.least > near_)) return {};
  double reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double p : {double(box.low[axis]), double(box.high[axis])}) {
      reach = std::max(reach, std::max(std::fabs(p), std::fabs(p - eye_[axis])));
    }
  }
  const double by = reach * kPlaceRounding + distances.largest * pixel_ +
                    kDepthRounding * distances.largest * (distances.largest / distances.least);
  AxisBox grown;
  for (int axis = 0; axis < 3; ++axis) {
    grown.low[axis] = -nextAbove(-float(box.low[axis] - by));
    grown.high[axis] = nextAbove(float(box.high[axis] + by));
  }
  if (!(frustum_.distancesOf(grown).least > std::max(near_, distances.least / 2))) return {};
  return grown;
}

}  // namespace sightline
