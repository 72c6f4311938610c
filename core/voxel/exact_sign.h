#pragma once

namespace sightline {

/// Sign (-1, 0, 1) of (a - c) x (b - c): 1 if a, b, c turn counterclockwise. Exact for all doubles of
/// magnitude 2^-300 to 2^300, and 0.
///
/// Based on: J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
/// Predicates, 1997: his filter (stage A), then a sum of expansions.
int orient2d(double ax, double ay, double bx, double by, double cx, double cy);

/// A point, or a vector.
struct ExactPoint {
  double x = 0, y = 0, z = 0;
};

/// Sign of ((b - a) x (c - a)) . (p - a): 1 if p lies on the side of the triangle's plane from which a, b, c
/// turn counterclockwise. Exact as orient2d.
int orient3d(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p);

/// Sign of d . ((a - c) x (b - c)) for a d of components -1, 0 and 1: 1 if a, b, c turn counterclockwise as
/// seen by who looks along -d. Exact as orient2d, which this is along an axis.
int orientAlong(const ExactPoint& d, const ExactPoint& a, const ExactPoint& b, const ExactPoint& c);

/// Sign of a + b + c + d. Exact as orient2d.
int signOfSum(double a, double b, double c, double d);

}  // namespace sightline
