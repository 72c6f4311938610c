#include "core/draw/make_camera.h"

#include <fmt/format.h>

#include <cmath>

#include "core/base/error.h"

namespace sightline {

namespace {

glm::dvec3 wide(const vec4& v) {
  return {v.x, v.y, v.z};
}

vec4 narrow(const glm::dvec3& v, float w) {
  return {float(v.x), float(v.y), float(v.z), w};
}

bool allFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Not glm's: sums in a fixed order, whatever it was built with.
double dotWide(const glm::dvec3& a, const glm::dvec3& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

glm::dvec3 crossWide(const glm::dvec3& a, const glm::dvec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

glm::dvec3 unit(const glm::dvec3& v) {
  return v / std::sqrt(dotWide(v, v));
}

void checkSize(uint32_t width, uint32_t height) {
  if (width == 0 || height == 0 || width > kLargestImageSide || height > kLargestImageSide) {
    throw Error(fmt::format("image of {} x {} pixels: width and height must be 1 to {}", width, height,
                            kLargestImageSide),
                kExitUsage);
  }
}

/// The tangent of an angle in (0, 90) degrees by Taylor's series: a mathematics library's may differ in its
/// last place.
double tangentOfDegrees(double degrees) {
  const bool steep = degrees > 45;
  const double x = (steep ? 90 - degrees : degrees) * 0x1.1df46a2529d39p-6;  // pi / 180
  double sine = 1, cosine = 1;
  for (int i = 20; i >= 2; i -= 2) {
    sine = 1 - sine * x * x / (i * (i + 1));
    cosine = 1 - cosine * x * x / ((i - 1) * i);
  }
  sine *= x;
  return steep ? cosine / sine : sine / cosine;
}

}  // namespace

Camera makeCamera(const ViewFrame& view, uint32_t width, uint32_t height, float near_distance) {
  checkSize(width, height);
  const glm::dvec3 right = wide(view.right), up = wide(view.up);
  const double across = dotWide(right, right), upwards = dotWide(up, up);
  if (!allFinite(wide(view.origin)) || !allFinite(wide(view.forward)) || !std::isfinite(across) ||
      !std::isfinite(upwards) || !(across > 0) || !(upwards > 0) || !(near_distance > 0) ||
      !std::isfinite(near_distance)) {
    throw Error("a camera must have a place, directions and a near plane that are finite, and see something",
                kExitUsage);
  }
  Camera camera;
  camera.eye = narrow(wide(view.origin), near_distance);
  camera.forward = narrow(wide(view.forward), 0);
  camera.across = narrow(right / across, 0);
  camera.down = narrow(up / -upwards, 0);
  camera.size = {width, height, 0, 0};
  return camera;
}

ViewFrame lookAt(const glm::dvec3& eye, const glm::dvec3& look, double fov, uint32_t width, uint32_t height) {
  checkSize(width, height);
  const glm::dvec3 along = look - eye;
  const double size = std::fmax(std::fmax(std::fabs(along.x), std::fabs(along.y)), std::fabs(along.z));
  if (!allFinite(eye) || !allFinite(look) || !(size > 0) || !std::isfinite(size)) {
    throw Error("a camera must look from one finite place to another", kExitUsage);
  }
  if (!(fov >= 1 && fov <= 179)) throw Error("a field of view must be 1 to 179 degrees", kExitUsage);
  const glm::dvec3 forward = unit(along / size);
  // Within 2^-20 of the vertical there is no telling where the horizon is.
  const bool level = std::fmax(std::fabs(forward.x), std::fabs(forward.z)) > 0x1p-20;
  const glm::dvec3 right = unit(crossWide(forward, level ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1)));
  const glm::dvec3 up = crossWide(right, forward);
  const double tangent = tangentOfDegrees(fov / 2);
  ViewFrame view;
  view.origin = narrow(eye, 0);
  view.forward = narrow(forward, 0);
  view.right = narrow(right * (tangent * width / height), 0);
  view.up = narrow(up * tangent, 0);
  return view;
}

float nearDistance(const AxisBox& bounds) {
  float reach = 0, extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    reach = std::fmax(reach, std::fmax(std::fabs(bounds.low[axis]), std::fabs(bounds.high[axis])));
    extent = std::fmax(extent, bounds.high[axis] - bounds.low[axis]);
  }
  const float size = extent > 0 ? std::fmin(reach, extent) : reach;
  if (!(size > 0)) return 0x1p-20f;  // one point at the origin
  int exponent = 0;
  std::frexp(size, &exponent);
  return std::ldexp(1.0f, exponent - 21);
}

}  // namespace sightline
