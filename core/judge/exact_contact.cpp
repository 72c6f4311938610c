#include "core/judge/exact_contact.h"

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <utility>

namespace sightline {
namespace {

using Kernel = CGAL::Simple_cartesian<ExactNumber>;
using ExactVector = Kernel::Vector_3;

ExactVector exactVector(const glm::dvec3& v) {
  return {ExactNumber(v.x), ExactNumber(v.y), ExactNumber(v.z)};
}

/// Six times the signed volume of the tetrahedron of 0, a, b and c.
ExactNumber volume(const ExactVector& a, const ExactVector& b, const ExactVector& c) {
  return CGAL::scalar_product(a, CGAL::cross_product(b, c));
}

int signOf(const ExactNumber& x) {
  return static_cast<int>(CGAL::sign(x));
}

/// number / divisor for a divisor of any sign but 0.
ExactQuotient withPositiveDivisor(ExactNumber number, ExactNumber divisor) {
  if (signOf(divisor) > 0) return {std::move(number), std::move(divisor)};
  return {-number, -divisor};
}

}  // namespace

int compare(const ExactQuotient& a, const ExactQuotient& b) {
  return signOf(ExactNumber(a.number * b.divisor - b.number * a.divisor));
}

DoubleRange rangeOf(const ExactQuotient& quotient) {
  const auto [low, high] = CGAL::to_interval(quotient.number);
  const auto [least, most] = CGAL::to_interval(quotient.divisor);
  const double t_low = low / (low < 0 ? least : most), t_high = high / (high < 0 ? most : least);
  return {std::nextafter(t_low, -HUGE_VAL), std::nextafter(t_high, HUGE_VAL)};
}

std::optional<ExactQuotient> exactPlaneDistance(const JudgeRay& ray, const JudgeTriangle& triangle) {
  const ExactVector a = exactVector(triangle.a);
  const ExactVector normal = CGAL::cross_product(exactVector(triangle.b) - a, exactVector(triangle.c) - a);
  ExactNumber along = CGAL::scalar_product(exactVector(ray.direction), normal);
  if (signOf(along) == 0) return std::nullopt;
  return withPositiveDivisor(CGAL::scalar_product(a - exactVector(ray.origin), normal), std::move(along));
}

std::optional<ExactQuotient> exactContact(const JudgeRay& ray, const JudgeTriangle& triangle) {
  const ExactVector origin = exactVector(ray.origin), d = exactVector(ray.direction);
  const ExactVector a = exactVector(triangle.a) - origin, b = exactVector(triangle.b) - origin,
                    c = exactVector(triangle.c) - origin;
  const int u = signOf(volume(d, b, c)), v = signOf(volume(d, c, a));
  if (u * v < 0) return std::nullopt;
  const int w = signOf(volume(d, a, b));
  if (v * w < 0 || w * u < 0) return std::nullopt;
  auto t = exactPlaneDistance(ray, triangle);
  if (!t || signOf(t->number) <= 0) return std::nullopt;
  return t;
}

}  // namespace sightline
