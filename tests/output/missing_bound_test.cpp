#include <gtest/gtest.h>

#include <cmath>

#include "core/pvs/pvs.h"

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

}  // namespace
}  // namespace sightline
