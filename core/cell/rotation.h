#pragma once

namespace sightline {

// Angles in degrees by series of our own: what depends on them is the same, bit for bit, with every C
// library; their sines, cosines and arc tangents differ in the last bit.

struct CosSin {
  double cosine;
  double sine;
};

/// Cosine and sine of any finite angle, to 1.5 units in the last place; exact at the multiples of 90 degrees,
/// where no zero is negative. NaN where the angle is not finite.
CosSin cosSinDegrees(double degrees);

/// Tangent of an angle between -90 and 90 degrees, both excluded, to three units in the last place.
double tanDegrees(double degrees);

/// Direction of the point (x, y) from the origin, -180 .. 180 degrees from the x axis towards the y axis, to
/// three units in the last place; exact at the multiples of 45 degrees. 0 at the origin. |x| + |y| must be
/// finite.
double atan2Degrees(double y, double x);

}  // namespace sightline
