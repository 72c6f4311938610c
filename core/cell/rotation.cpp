#include "core/cell/rotation.h"

#include <cmath>

namespace sightline {
namespace {

/// A degree in radians, and what the double leaves over of it.
constexpr double kRadians = 3.14159265358979323846 / 180, kRadiansLeft = 2.9486522708701687e-19;
constexpr double kDegrees = 180 / 3.14159265358979323846;

// Taylor's series from the last term to the first. Factorials up to 18 are doubles, so their reciprocals are
// correctly rounded.
constexpr int kLastSineTerm = 17;    // pi / 4: the next is 7e-20 of the sine there
constexpr int kLastCosineTerm = 18;  // 6e-21
constexpr int kArcTerms = 22;        // tan(22.5 degrees): the next is 7e-19 of the arc there

constexpr double factorial(int n) {
  return n < 2 ? 1.0 : n * factorial(n - 1);
}

/// Of -45 .. 45 degrees.
CosSin cosSinNearZero(double degrees) {
  // The angle is x + rest: of a product and what rounding took from it.
  const double x = degrees * kRadians, xx = x * x;
  const double rest = std::fma(degrees, kRadians, -x) + degrees * kRadiansLeft;
  double sine = 0, cosine = 0;
  for (int n = kLastSineTerm; n > 1; n -= 2) sine = 1 / factorial(n) - xx * sine;
  for (int n = kLastCosineTerm; n > 2; n -= 2) cosine = 1 / factorial(n) - xx * cosine;
  // To the first order sin(x + rest) = sin x + rest cos x, cos(x + rest) = cos x - rest sin x.
  return {1 - (0.5 * xx - (xx * xx * cosine - x * rest)), x - (x * xx * sine - rest * (1 - 0.5 * xx))};
}

/// In radians, of -tan(pi / 8) .. tan(pi / 8).
double arcOf(double tangent) {
  const double square = tangent * tangent;
  double sum = 0;
  for (int n = kArcTerms; n > 0; --n) sum = 1.0 / (2 * n + 1) - square * sum;
  return tangent - tangent * square * sum;
}

/// Of 0 < small <= large, 0 .. 45 degrees.
double arcDegrees(double small, double large) {
  // tan(a - 45 degrees) = (tan a - 1) / (tan a + 1).
  constexpr double kTangentOfEighth = 0.41421356237309503;
  if (small <= kTangentOfEighth * large) return arcOf(small / large) * kDegrees;
  return 45 + arcOf((small - large) / (small + large)) * kDegrees;
}

}  // namespace

CosSin cosSinDegrees(double degrees) {
  // Exact, as the remainders of divisions are.
  const double turned = std::remainder(degrees, 360.0);
  const double quarters = std::nearbyint(turned / 90);
  const auto [cosine, sine] = cosSinNearZero(turned - 90 * quarters);
  // Adding 0.0 turns -0.0 into 0.0.
  if (quarters == 0) return {cosine, sine + 0.0};
  if (quarters == 1) return {0.0 - sine, cosine};
  if (quarters == -1) return {sine + 0.0, -cosine};
  return {-cosine, 0.0 - sine};
}

double tanDegrees(double degrees) {
  const CosSin at = cosSinDegrees(degrees);
  return at.sine / at.cosine;
}

double atan2Degrees(double y, double x) {
  const double width = std::fabs(x), height = std::fabs(y);
  if (width == 0 && height == 0) return 0;
  double degrees = height <= width ? arcDegrees(height, width) : 90 - arcDegrees(width, height);
  if (x < 0) degrees = 180 - degrees;
  return y < 0 ? -degrees : degrees;
}

}  // namespace sightline
