#pragma once
#include <cmath>

namespace sightline {

/// The angle of the direction (x, y) from the x axis in degrees, -180 to 180, as atan2 has it, from +, -, *,
/// / and square roots alone: the same bits on every machine, where those of std::atan2 depend on the C
/// library. Wrong by at most 1e-13 degrees; exact along the axes. 0 for the zero vector.
///
/// Halving the angle three times (tan(a / 2) = tan a / (1 + sqrt(1 + tan^2 a))) leaves at most 5.7 degrees,
/// where the series of the arc tangent ends below 1e-18.
inline double arcTangentDegrees(double y, double x) {
  constexpr double kDegrees = 57.295779513082320877;
  constexpr int kTerms = 9;
  const double small = std::fmin(std::fabs(x), std::fabs(y)), large = std::fmax(std::fabs(x), std::fabs(y));
  if (large == 0) return 0;
  double t = small / large;
  for (int halving = 0; halving < 3; ++halving) t /= 1 + std::sqrt(1 + t * t);
  double series = 0;
  for (int term = kTerms; term >= 0; --term)
    series = (term % 2 == 0 ? 1.0 : -1.0) / (2 * term + 1) + t * t * series;
  double angle = 8 * t * series * kDegrees;
  if (std::fabs(y) > std::fabs(x)) angle = 90 - angle;
  if (x < 0) angle = 180 - angle;
  return y < 0 ? -angle : angle;
}

}  // namespace sightline
