#pragma once
#include <cmath>

// Logarithm and exponential by additions, multiplications and divisions in double alone, which IEEE 754
// rounds alike everywhere. A mathematics library's own may differ in the last place from one to the next, and
// what decides when a bake stops, or is written into its file, must not.
namespace sightline {

/// ln 2 in two parts: multiples of the first by whole numbers up to 2^20 are exact.
inline constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;

/// Natural logarithm of a finite x > 0, to some units in the last place.
inline double portableLog(double x) {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // exact, 0.5 .. 1
  if (mantissa < 0x1.6a09e667f3bcdp-1) {       // below the root of 1/2
    mantissa *= 2;
    --exponent;
  }
  // log m = 2 artanh s = 2 (s + s^3 / 3 + s^5 / 5 + ...), |s| < 0.172: the last term is below 2^-60 of the
  // first.
  const double s = (mantissa - 1) / (mantissa + 1), square = s * s;
  double sum = 0;
  for (int i = 23; i >= 3; i -= 2) sum = (sum + 1.0 / i) * square;
  return exponent * kLn2High + (2 * s + (2 * s * sum + exponent * kLn2Low));
}

/// e^x - 1 of |x| <= 0.5: Taylor's series.
inline double portableExpm1Small(double x) {
  double sum = 1;
  for (int i = 18; i >= 2; --i) sum = 1 + sum * x / i;
  return sum * x;
}

/// e^x of any finite x: 0 below the smallest double, infinite above the largest.
inline double portableExp(double x) {
  if (x < -746) return 0;
  if (x > 710) return HUGE_VAL;
  const double twos = std::floor(x / (kLn2High + kLn2Low) + 0.5);
  const double rest = (x - twos * kLn2High) - twos * kLn2Low;  // |rest| < 0.35
  return std::ldexp(1 + portableExpm1Small(rest), int(twos));
}

/// e^x - 1 with all its digits where x is small.
inline double portableExpm1(double x) {
  return std::fabs(x) <= 0.5 ? portableExpm1Small(x) : portableExp(x) - 1;
}

}  // namespace sightline
