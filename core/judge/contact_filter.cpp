#include "core/judge/contact_filter.h"

#include <cmath>

namespace sightline {
namespace {

/// 64 units of rounding: see the header.
constexpr double kErrorShare = 0x1p-47;
/// Widens a quotient for its own rounding and that of the bounds.
constexpr double kQuotientShare = 0x1p-50;

int certainSign(double value, double error) {
  return value > error ? 1 : (value < -error ? -1 : 0);
}

/// The quotient of two ranges given by middle and error; the divisor's does not hold 0.
DoubleRange quotient(double number, double number_error, double divisor, double divisor_error) {
  if (divisor < 0) {
    number = -number;
    divisor = -divisor;
  }
  const double low = number - number_error, high = number + number_error;
  const double least = divisor - divisor_error, most = divisor + divisor_error;
  const double t_low = low / (low < 0 ? least : most), t_high = high / (high < 0 ? most : least);
  return {t_low - std::fabs(t_low) * kQuotientShare, t_high + std::fabs(t_high) * kQuotientShare};
}

}  // namespace

bool filterPlaneDistance(const JudgeRay& ray, const JudgeTriangle& triangle, DoubleRange& t) {
  const glm::dvec3 a = triangle.a - ray.origin;
  const glm::dvec3 ab = triangle.b - triangle.a, ac = triangle.c - triangle.a;
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double share = kErrorShare * maxAbs(ab) * maxAbs(ac);
  const double along = glm::dot(ray.direction, normal), along_error = share * maxAbs(ray.direction);
  if (!(std::fabs(along) > along_error)) return false;
  t = quotient(glm::dot(a, normal), share * maxAbs(a), along, along_error);
  return true;
}

FilteredContact filterContact(const JudgeRay& ray, const JudgeTriangle& triangle, double t_limit) {
  const glm::dvec3 a = triangle.a - ray.origin, b = triangle.b - ray.origin, c = triangle.c - ray.origin;
  const double d_size = kErrorShare * maxAbs(ray.direction);
  const double a_size = maxAbs(a), b_size = maxAbs(b), c_size = maxAbs(c);
  const int u = certainSign(glm::dot(ray.direction, glm::cross(b, c)), d_size * b_size * c_size);
  const int v = certainSign(glm::dot(ray.direction, glm::cross(c, a)), d_size * c_size * a_size);
  if (u * v < 0) return {Certainty::kMiss, {}};
  const int w = certainSign(glm::dot(ray.direction, glm::cross(a, b)), d_size * a_size * b_size);
  if (v * w < 0 || w * u < 0) return {Certainty::kMiss, {}};
  DoubleRange t;
  if (!filterPlaneDistance(ray, triangle, t)) return {Certainty::kUnsure, {}};
  if (t.high <= 0 || t.low > t_limit) return {Certainty::kMiss, {}};
  const bool inside = u * v > 0 && v * w > 0;
  return {inside && t.low > 0 ? Certainty::kHit : Certainty::kUnsure, t};
}

}  // namespace sightline
