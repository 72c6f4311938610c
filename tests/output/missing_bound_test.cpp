#include "core/pvs/missing_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/portable_math.h"

namespace sightline {
namespace {

/// P(X <= k) for X binomial(n, p), term by term in long double.
long double binomialTail(uint64_t k, uint64_t n, long double p) {
  long double log_term = n * std::log1p(-p), sum = std::exp(log_term);
  for (uint64_t i = 1; i <= k; ++i) {
    log_term += std::log((long double)(n - i + 1) / i) + std::log(p) - std::log1p(-p);
    sum += std::exp(log_term);
  }
  return sum;
}

TEST(MissingUpperBound, HasItsClosedFormForNoneMissing) {
  EXPECT_EQ(missingUpperBound(0, 0), 1);
  EXPECT_DOUBLE_EQ(missingUpperBound(0, 1), 0.975);
  EXPECT_DOUBLE_EQ(missingUpperBound(0, 10), 1 - std::pow(0.025, 0.1));
  // -ln(0.025) / n for many rays.
  EXPECT_NEAR(missingUpperBound(0, 10'000'000) * 1e7, 3.6888794541139363, 1e-6);
  EXPECT_NEAR(missingUpperBound(0, 10'000'000'000) * 1e10, 3.6888794541139363, 1e-8);
}

TEST(MissingUpperBound, MatchesTablesOfTheBinomial) {
  EXPECT_NEAR(missingUpperBound(5, 10), 0.8129, 5e-5);
  EXPECT_NEAR(missingUpperBound(3, 100), 0.0852, 5e-5);
  EXPECT_EQ(missingUpperBound(10, 10), 1);
  EXPECT_EQ(missingUpperBound(11, 10), 1);
}

TEST(MissingUpperBound, MatchesTablesOfPoissonForManyRays) {
  // Half the 0.975 quantile of chi-square with 2 (k + 1) degrees of freedom.
  EXPECT_NEAR(missingUpperBound(1, 10'000'000'000) * 1e10, 5.571643390938898, 1e-7);
  EXPECT_NEAR(missingUpperBound(10, 10'000'000'000) * 1e10, 18.390356042145, 1e-6);
}

TEST(MissingUpperBound, LeavesTheTailThatItPromises) {
  for (uint64_t n : {2ull, 17ull, 1000ull, 1'000'000ull, 10'000'000'000ull}) {
    for (uint64_t k : {1ull, 2ull, 15ull, 16ull, 500ull, 5000ull}) {
      if (k >= n) continue;
      const double bound = missingUpperBound(k, n);
      EXPECT_NEAR(double(binomialTail(k, n, bound)), 0.025, 0.025 * 1e-8) << k << " of " << n;
    }
  }
}

TEST(MissingUpperBound, GrowsWithTheMissingAndStaysAboveTheShare) {
  double before = 0;
  for (uint64_t k : {0ull, 1ull, 1000ull, 1'000'000ull, 5'000'000'000ull, 9'999'999'999ull}) {
    const double bound = missingUpperBound(k, 10'000'000'000ull);
    EXPECT_GT(bound, before);
    EXPECT_GT(bound, double(k) * 1e-10);
    before = bound;
  }
  // Normal approximation, good to 1e-5 of the distance here.
  EXPECT_NEAR(missingUpperBound(5'000'000'000ull, 10'000'000'000ull) - 0.5, 1.959964 * 0.5e-5, 1e-9);
}

/// One-sided bounds: the two-sided one at half its tail; 0 of n in closed form.
TEST(MissingBound, OneSidedAtAnyTail) {
  EXPECT_EQ(missingUpperBound(7, 1000, 0.025), missingUpperBound(7, 1000));
  EXPECT_NEAR(missingUpperBound(0, 1000, 0.05), 1 - std::pow(0.05, 1e-3), 1e-15);
  EXPECT_LT(missingUpperBound(7, 1000, 0.05), missingUpperBound(7, 1000, 0.01));
}

/// With so many rays the bound is below the share, with one less it is not.
TEST(MissingBound, RaysForABound) {
  for (const uint64_t missing : {0u, 1u, 8u, 100u}) {
    for (const double share : {0.9, 0.3, 1e-2, 1e-6}) {
      for (const double tail : {0.03, 1e-3, 1e-8}) {
        const uint64_t rays = raysForBound(missing, share, tail);
        EXPECT_LT(missingUpperBound(missing, rays, tail), share)
            << missing << " at " << share << ", " << tail;
        EXPECT_GE(missingUpperBound(missing, rays - 1, tail), share)
            << missing << " at " << share << ", " << tail;
      }
    }
  }
  // Poisson: exp(-x) = 0.05.
  EXPECT_NEAR(double(raysForBound(0, 1e-6, 0.05)), 2.9957e6, 100);
}

/// Bounds stand in files and decide when a bake stops: the same bits with every mathematics library.
TEST(MissingBound, IsTheSameToTheLastBitEverywhere) {
  EXPECT_EQ(missingUpperBound(0, 1'000'000), 0x1.ef1cb2fa718e6p-19);
  EXPECT_EQ(missingUpperBound(3, 10), 0x1.4e0e4cca611dbp-1);
  EXPECT_EQ(missingUpperBound(7, 1000), 0x1.d6d98b408cffcp-7);
  EXPECT_EQ(missingUpperBound(100, 100'000), 0x1.3ecd882fe79c5p-10);
  EXPECT_EQ(missingUpperBound(5, 10'000'000'000), 0x1.40bc9665105a3p-30);
  EXPECT_EQ(raysForBound(8, 0.001, 0.03), 15419u);
  EXPECT_EQ(raysForBound(8, 1e-6, 0.001), 21156192u);
  EXPECT_EQ(raysForBound(0, 0x1p-20, 1e-8), 19315475u);
}

/// lgamma writes a variable of the whole process; bounds are asked for on several threads.
TEST(MissingBound, WritesNothingThatOthersRead) {
  signgam = 42;
  missingUpperBound(3, 10);
  EXPECT_EQ(signgam, 42);
}

/// The difference in units in the last place of `want`.
double ulps(double got, long double want) {
  const double near = double(want);
  return double(std::fabs(got - want)) / (std::nextafter(std::fabs(near), HUGE_VAL) - std::fabs(near));
}

TEST(PortableMath, IsRightToAFewUnitsInTheLastPlace) {
  const unsigned seed = 3;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponents(-700, 700), near_zero(-1, 1);
  for (int i = 0; i < 100'000; ++i) {
    const double x = exponents(random), y = std::exp(x), z = near_zero(random), near_one = 1 + z * 1e-3;
    ASSERT_LE(ulps(portableExp(x), std::exp((long double)x)), 2) << x << " seed " << seed;
    ASSERT_LE(ulps(portableLog(y), std::log((long double)y)), 3) << y << " seed " << seed;
    ASSERT_LE(ulps(portableLog(near_one), std::log((long double)near_one)), 3)
        << near_one << " seed " << seed;
    ASSERT_LE(ulps(portableExpm1(z), std::expm1((long double)z)), 3) << z << " seed " << seed;
  }
  EXPECT_EQ(portableLog(1), 0);
  EXPECT_EQ(portableExp(0), 1);
  EXPECT_EQ(portableExpm1(0), 0);
  EXPECT_EQ(portableExp(-800), 0);
  EXPECT_EQ(portableExp(800), HUGE_VAL);
}

}  // namespace
}  // namespace sightline
