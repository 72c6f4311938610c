#include "core/gvs/iteration_forecast.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

constexpr uint32_t kThreshold = 10;

/// After `iterations` that found scale / i^power.
IterationForecast after(uint32_t iterations, double scale, double power) {
  IterationForecast forecast;
  for (uint32_t i = 1; i <= iterations; ++i) {
    forecast.add(static_cast<uint32_t>(scale / std::pow(double(i), power)));
  }
  return forecast;
}

TEST(IterationForecast, FollowsAPowerOfTheIteration) {
  EXPECT_NEAR(after(100, 4000, 1).due(kThreshold), 300, 30);  // 4000 / 400 = 10
  EXPECT_NEAR(after(20, 4000, 1).due(kThreshold), 380, 80);
  EXPECT_NEAR(after(20, 25'000, 2).due(kThreshold), 30, 6);
}

TEST(IterationForecast, ExpectsAnotherIterationUntilOneIsQuiet) {
  EXPECT_EQ(IterationForecast().due(kThreshold), 1);
  EXPECT_EQ(after(3, 1000, 1).due(kThreshold), 1);
  EXPECT_EQ(after(12, 120, 1).due(kThreshold), 1);
  EXPECT_EQ(after(13, 120, 1).due(kThreshold), 0);
}

TEST(IterationForecast, StaysFiniteWhereNothingFallsOff) {
  const double due = after(50, 100'000, 0).due(kThreshold);
  EXPECT_GT(due, 50);
  EXPECT_TRUE(std::isfinite(due));
}

}  // namespace
}  // namespace sightline
