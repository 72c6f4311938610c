#include "core/gvs/iteration_forecast.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

constexpr uint32_t kThreshold = 10;

/// After `iterations` that found scale / i.
IterationForecast after(uint32_t iterations, uint32_t scale) {
  IterationForecast forecast;
  for (uint32_t i = 1; i <= iterations; ++i) forecast.add(scale / i);
  return forecast;
}

TEST(IterationForecast, FollowsTheFall) {
  EXPECT_NEAR(after(100, 4000).due(kThreshold), 300, 60);  // 4000 / 400 = 10
  EXPECT_NEAR(after(20, 4000).due(kThreshold), 380, 60);
  EXPECT_NEAR(after(300, 4000).due(kThreshold), 100, 60);
}

TEST(IterationForecast, ExpectsAnotherIterationUntilOneIsQuiet) {
  EXPECT_EQ(IterationForecast().due(kThreshold), 1);
  EXPECT_EQ(after(3, 1000).due(kThreshold), 1);
  EXPECT_NEAR(after(12, 120).due(kThreshold), 1, 1.5);
  EXPECT_GE(after(12, 120).due(kThreshold), 1);
  EXPECT_EQ(after(13, 120).due(kThreshold), 0);
}

}  // namespace
}  // namespace sightline
