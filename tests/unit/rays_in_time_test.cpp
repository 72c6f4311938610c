#include "core/gvs/rays_in_time.h"

#include <gtest/gtest.h>

namespace sightline {
namespace {

constexpr uint64_t kMost = 1u << 20;

TEST(RaysInTime, FollowsTheSlowestStage) {
  CellStats stats;
  stats.random = {10'000'000, 0, 10};  // a tenth of their rate until there are border rays
  EXPECT_EQ(raysInTime(stats, 2, kMost), 200'000u);
  stats.border = {50'000, 0, 1};
  EXPECT_EQ(raysInTime(stats, 2, kMost), 100'000u);
  stats.reverse = {20'000, 0, 1};
  EXPECT_EQ(raysInTime(stats, 2, kMost), 40'000u);
  EXPECT_EQ(raysInTime(stats, 1e9, kMost), kMost);
  EXPECT_EQ(raysInTime(stats, -1, kMost), kFewestBatchRays);
}

/// 0 / 0 would be no number, and no number has no conversion to an integer.
TEST(RaysInTime, IsWithinItsBoundsWhereTheClockStoodStill) {
  CellStats stats;
  EXPECT_EQ(raysInTime(stats, 1, kMost), kFewestBatchRays);
  EXPECT_EQ(raysInTime(stats, 0, kMost), kFewestBatchRays);
  stats.random = {1000, 0, 0};
  EXPECT_EQ(raysInTime(stats, 1, kMost), kMost);
  EXPECT_EQ(raysInTime(stats, 0, kMost), kFewestBatchRays);
  stats.border = {1000, 0, 0};
  EXPECT_EQ(raysInTime(stats, 0, kMost), kFewestBatchRays);
}

}  // namespace
}  // namespace sightline
