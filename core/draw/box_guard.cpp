#include "core/draw/box_guard.h"

#include <cmath>
#include <limits>

namespace sightline {

namespace {

constexpr double kPlaceRounding = 0x1p-20;
constexpr double kDepthRounding = 0x1p-20;
constexpr double kSnappedPixels = 1.0 / 128;

double lengthOf(const vec4& v) {
  return std::sqrt((double(v.x) * v.x + double(v.y) * v.y) + double(v.z) * v.z);
}

}  // namespace

BoxGuard::BoxGuard(const Camera& camera)
    : frustum_(camera), eye_(camera.eye.x, camera.eye.y, camera.eye.z), near_(camera.eye.w) {
  // At distance d the image is 2 d / |across| wide.
  pixel_ = kSnappedPixels * std::fmax(2 / (lengthOf(camera.across) * camera.size.x),
                                      2 / (lengthOf(camera.down) * camera.size.y));
}

std::optional<AxisBox> BoxGuard::grown(const AxisBox& box) const {
  const Frustum::Distances distances = frustum_.distancesOf(box);
  if (!(distances.least > near_)) return {};
  double reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double p : {double(box.low[axis]), double(box.high[axis])}) {
      reach = std::fmax(reach, std::fmax(std::fabs(p), std::fabs(p - eye_[axis])));
    }
  }
  const double by = reach * kPlaceRounding + distances.largest * pixel_ +
                    kDepthRounding * distances.largest * (distances.largest / distances.least);
  constexpr float kEnd = std::numeric_limits<float>::infinity();
  AxisBox grown;
  for (int axis = 0; axis < 3; ++axis) {
    grown.low[axis] = std::nextafter(float(box.low[axis] - by), -kEnd);
    grown.high[axis] = std::nextafter(float(box.high[axis] + by), kEnd);
  }
  if (!(frustum_.distancesOf(grown).least > std::fmax(near_, distances.least / 2))) return {};
  return grown;
}

}  // namespace sightline
