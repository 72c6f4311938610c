// Based on: C. Clopper and E. Pearson, "The use of confidence or fiducial limits illustrated in the case of
// the binomial", Biometrika 1934; the binomial's probabilities after C. Loader, "Fast and accurate
// computation of binomial probabilities", 2000: saddle point and deviance instead of differences of
// logarithms of factorials, which at 1e10 rays would lose six digits.
#include "core/pvs/missing_bound.h"

#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

namespace sightline {
namespace {

/// Share of the probability left out on each side of a two-sided interval of 95 %.
constexpr double kTail = 0.025;

constexpr double kTwoPi = 2 * std::numbers::pi;

/// log(n!) minus Stirling's approximation of it, n a whole number above 0.
double stirlingError(double n) {
  if (n < 16) {
    double factorial = 1;  // 15! has 13 digits: exact
    for (double i = 2; i <= n; ++i) factorial *= i;
    return portableLog(factorial) - (n + 0.5) * portableLog(n) + n - 0.5 * portableLog(kTwoPi);
  }
  const double n2 = n * n;
  return (1.0 / 12 - (1.0 / 360 - (1.0 / 1260 - (1.0 / 1680) / n2) / n2) / n2) / n;
}

/// x log(x / mean) + mean - x, without cancellation where the two are near.
double deviance(double x, double mean) {
  const double difference = x - mean;
  if (std::fabs(difference) > 0.1 * (x + mean)) return x * portableLog(x / mean) - difference;
  const double v = difference / (x + mean);
  double sum = difference * v, power = 2 * x * v;
  for (int i = 1; i < 1000; ++i) {
    power *= v * v;
    const double next = sum + power / (2 * i + 1);
    if (next == sum) break;
    sum = next;
  }
  return sum;
}

/// Probability of exactly k of n, 0 < k < n, 0 < p < 1.
double binomialProbability(double k, double n, double p) {
  const double exponent = stirlingError(n) - stirlingError(k) - stirlingError(n - k) - deviance(k, n * p) -
                          deviance(n - k, n * (1 - p));
  return portableExp(exponent) * std::sqrt(n / (kTwoPi * k * (n - k)));
}

/// Probability of k or fewer of n, k <= n p: terms shrink from k downwards.
double lowerTail(double k, double n, double p) {
  double term = binomialProbability(k, n, p), sum = term;
  for (double i = k; i > 0 && term > sum * 1e-17; --i) {
    term *= i / (n - i + 1) * ((1 - p) / p);
    sum += term;
  }
  return sum;
}

}  // namespace

double missingUpperBound(uint64_t missing, uint64_t rays) {
  return missingUpperBound(missing, rays, kTail);
}

double missingUpperBound(uint64_t missing, uint64_t rays, double tail) {
  if (missing >= rays) return 1;
  const double n = double(rays), k = double(missing);
  if (missing == 0) return -portableExpm1(portableLog(tail) / n);  // 1 - tail^(1/n)
  double low = k / n, high = 1;
  while (true) {
    // Small shares need their digits too: halve the ratio while it is large.
    const double middle = high > 2 * low ? std::sqrt(low * high) : 0.5 * (low + high);
    if (middle <= low || middle >= high) return high;
    (lowerTail(k, n, middle) > tail ? low : high) = middle;
  }
}

uint64_t raysForBound(uint64_t missing, double share, double tail) {
  const auto proves = [&](uint64_t rays) { return missingUpperBound(missing, rays, tail) < share; };
  uint64_t low = missing, high = missing + 1;  // of `missing` rays all miss: no bound
  while (!proves(high)) low = high, high *= 2;
  while (high - low > 1) {
    const uint64_t middle = low + (high - low) / 2;
    (proves(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace sightline
