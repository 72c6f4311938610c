#include "core/judge/surface_contact.h"

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>

#include "core/judge/exact_contact.h"

namespace sightline {
namespace {

using Kernel = CGAL::Simple_cartesian<ExactNumber>;
using ExactVector = Kernel::Vector_3;

/// 64 units of rounding for each volume (contact_filter.h); three volumes make the divisor.
constexpr double kVolumeError = 3 * 0x1p-47;

/// A number's whole units of `unit`, exactly: number / divisor is in the record's units.
int64_t wholeUnits(const ExactNumber& number, const ExactNumber& divisor, double unit) {
  const auto [low, high] = CGAL::to_interval(number);
  const auto [least, most] = CGAL::to_interval(divisor);
  auto whole = int64_t(std::floor((low + high) / (least + most) / unit));
  const auto beyond = [&](int64_t units) {  // number / divisor < units * unit
    return CGAL::sign(ExactNumber(number - ExactNumber(double(units) * unit) * divisor)) < 0;
  };
  while (beyond(whole)) --whole;
  while (!beyond(whole + 1)) ++whole;
  return whole;
}

/// Volumes of the ray with the edges: shares of the three corners times their sum.
struct ExactShares {
  ExactNumber a, b, c, sum;
};

ExactShares exactShares(const JudgeRay& ray, const JudgeTriangle& shape) {
  const auto exact = [](const glm::dvec3& v) {
    return ExactVector(ExactNumber(v.x), ExactNumber(v.y), ExactNumber(v.z));
  };
  const ExactVector origin = exact(ray.origin), d = exact(ray.direction), a = exact(shape.a) - origin,
                    b = exact(shape.b) - origin, c = exact(shape.c) - origin;
  const auto volume = [&](const ExactVector& p, const ExactVector& q) {
    return ExactNumber(CGAL::scalar_product(d, CGAL::cross_product(p, q)));
  };
  ExactShares shares{volume(b, c), volume(c, a), volume(a, b), {}};
  shares.sum = shares.a + shares.b + shares.c;
  if (CGAL::sign(shares.sum) < 0) shares = {-shares.a, -shares.b, -shares.c, -shares.sum};
  return shares;
}

uint32_t wrapped(int64_t texel, uint32_t size, uint32_t wrap) {
  if (wrap == kWrapClamp) return uint32_t(std::clamp<int64_t>(texel, 0, int64_t(size) - 1));
  const int64_t period = wrap == kWrapMirror ? 2 * int64_t(size) : int64_t(size);
  const int64_t inside = (texel % period + period) % period;
  return uint32_t(inside < size ? inside : period - 1 - inside);
}

bool meetsTexel(const Surfaces& surfaces, const MaskedTriangle& record, const JudgeRay& ray,
                const JudgeTriangle& shape) {
  const uvec4 mask = surfaces.masks[record.corner_c_mask.z].size_wrap_first;
  const double unit = std::ldexp(1.0, int(record.corner_c_mask.w));  // of a texel, in units of the record
  const glm::dvec3 a = shape.a - ray.origin, b = shape.b - ray.origin, c = shape.c - ray.origin;
  const double u = glm::dot(ray.direction, glm::cross(b, c)), v = glm::dot(ray.direction, glm::cross(c, a)),
               w = glm::dot(ray.direction, glm::cross(a, b)), sum = u + v + w;
  const double size = std::max({maxAbs(a), maxAbs(b), maxAbs(c)});
  const double error = 4 * kVolumeError * maxAbs(ray.direction) * size * size / std::fabs(sum);
  int64_t texel[2];
  for (int axis = 0; axis < 2; ++axis) {
    const double places[3] = {double(record.corners_ab[axis]) - kTexelOffset,
                              double(record.corners_ab[axis + 2]) - kTexelOffset,
                              double(record.corner_c_mask[axis]) - kTexelOffset};
    const double place = (places[0] * u + places[1] * v + places[2] * w) / sum / unit;
    const double largest =
        std::max({std::fabs(places[0]), std::fabs(places[1]), std::fabs(places[2]), 1.0}) / unit;
    const double slack = (error + 0x1p-48) * 3 * largest;
    texel[axis] = int64_t(std::floor(place));
    if (std::floor(place - slack) == std::floor(place + slack)) continue;  // false for NaN too
    const ExactShares shares = exactShares(ray, shape);
    texel[axis] = wholeUnits(ExactNumber(places[0]) * shares.a + ExactNumber(places[1]) * shares.b +
                                 ExactNumber(places[2]) * shares.c,
                             shares.sum, unit);
  }
  const uint32_t bit =
      wrapped(texel[1], mask.y, mask.z >> 2) * mask.x + wrapped(texel[0], mask.x, mask.z & 3u);
  return (surfaces.texels[mask.w + bit / 32] >> (bit % 32) & 1u) != 0;
}

/// Of a ray that is not in the triangle's plane.
bool meetsFront(const JudgeRay& ray, const JudgeTriangle& shape) {
  const glm::dvec3 ab = shape.b - shape.a, ac = shape.c - shape.a;
  const double along = glm::dot(ray.direction, glm::cross(ab, ac));
  const double error = 0x1p-47 * maxAbs(ray.direction) * maxAbs(ab) * maxAbs(ac);
  if (std::fabs(along) > error) return along < 0;
  const auto exact = [](const glm::dvec3& v) {
    return ExactVector(ExactNumber(v.x), ExactNumber(v.y), ExactNumber(v.z));
  };
  const ExactVector a = exact(shape.a);
  return CGAL::sign(ExactNumber(CGAL::scalar_product(
             exact(ray.direction), CGAL::cross_product(exact(shape.b) - a, exact(shape.c) - a)))) < 0;
}

}  // namespace

bool meetsSurface(const Scene& scene, uint32_t triangle, const JudgeRay& ray, const JudgeTriangle& shape) {
  const uint32_t surface = scene.surfaceOf(triangle);
  if ((surface & kSurfaceFrontOnly) != 0 && !meetsFront(ray, shape)) return false;
  if ((surface & kSurfaceMasked) == 0) return true;
  return meetsTexel(scene.surfaces, scene.maskPlaces(triangle), ray, shape);
}

}  // namespace sightline
