// When a cell's bake ends, told by counts and seconds alone.
#include "core/gvs/stop_rule.h"

#include <gtest/gtest.h>

#include <vector>

namespace sightline {
namespace {

/// An iteration of one launch: rays and seconds at its end, and the triangles that it found.
struct Iteration {
  uint64_t rays;
  double seconds;
  uint32_t found;
};

struct StopCase {
  const char* name;
  BakeParams params;
  std::vector<Iteration> iterations;
  size_t ends_after;  ///< so many of them; 0: it goes on
  StopReason reason;
};

BakeParams limits(uint32_t threshold, uint32_t quiet, uint64_t max_rays = 0, double max_seconds = 0) {
  BakeParams params;
  params.threshold = threshold;
  params.quiet_iterations = quiet;
  params.max_rays = max_rays;
  params.max_seconds = max_seconds;
  return params;
}

TEST(StopRule, EndsWhereTheTableSays) {
  const std::vector<Iteration> falling = {{100, 1, 50}, {200, 2, 10}, {300, 3, 9}, {400, 4, 0}};
  const std::vector<Iteration> uneven = {{100, 1, 5}, {200, 2, 10}, {300, 3, 9}, {400, 4, 9}};
  const StopCase cases[] = {
      {"the first with fewer than T", limits(10, 1), falling, 3, StopReason::kConverged},
      {"T itself is not fewer", limits(9, 1), falling, 4, StopReason::kConverged},
      {"T = 0 never ends", limits(0, 1), falling, 0, StopReason::kConverged},
      {"T = 1: nothing new", limits(1, 1), falling, 4, StopReason::kConverged},
      {"two quiet ones", limits(10, 2), falling, 4, StopReason::kConverged},
      {"quiet ones in a row only", limits(10, 2), uneven, 4, StopReason::kConverged},
      {"three quiet ones never come", limits(10, 3), uneven, 0, StopReason::kConverged},
      {"a limit of rays, reached", limits(0, 1, 300), falling, 3, StopReason::kRayLimit},
      {"a limit of rays, passed", limits(0, 1, 299), falling, 3, StopReason::kRayLimit},
      {"a limit of rays, not reached", limits(0, 1, 401), falling, 0, StopReason::kConverged},
      {"a limit of time, reached", limits(0, 1, 0, 2), falling, 2, StopReason::kTimeLimit},
      {"a limit of time, passed", limits(0, 1, 0, 1.5), falling, 2, StopReason::kTimeLimit},
      {"both limits at once", limits(0, 1, 200, 2), falling, 2, StopReason::kTimeLimit},
      {"T before a limit", limits(10, 1, 400), falling, 3, StopReason::kConverged},
      {"a limit before T", limits(10, 1, 100), falling, 1, StopReason::kRayLimit},
      {"a limit and T in one iteration", limits(10, 1, 300), falling, 3, StopReason::kRayLimit},
  };
  for (const StopCase& c : cases) {
    SCOPED_TRACE(c.name);
    StopRule rule(c.params);
    size_t ended = 0;
    for (size_t i = 0; i < c.iterations.size() && ended == 0; ++i) {
      const Iteration& iteration = c.iterations[i];
      const bool goes_on = rule.afterLaunch(iteration.rays, iteration.seconds);
      EXPECT_EQ(goes_on, rule.unlimited());
      EXPECT_FALSE(rule.testDue(iteration.rays)) << "there is no target";
      if (rule.endsAfter(iteration.found)) ended = i + 1;
    }
    EXPECT_EQ(ended, c.ends_after);
    EXPECT_EQ(rule.reason(), c.reason);
  }
}

TEST(StopRule, ATargetStandsInTheThresholdsStead) {
  BakeParams params = limits(10, 1);
  params.target_error = 0.01;
  StopRule rule(params);
  EXPECT_TRUE(rule.afterLaunch(1000, 1));
  EXPECT_FALSE(rule.endsAfter(0)) << "quiet, but not tested";
  EXPECT_TRUE(rule.testDue(1000));
  EXPECT_EQ(rule.mostTestRays(1000), ~uint64_t(0));
  EXPECT_FALSE(rule.afterTest(false, 1000, 50));
  EXPECT_FALSE(rule.testDue(1199)) << "four times the test's rays have to come first";
  EXPECT_TRUE(rule.testDue(1200));
  EXPECT_EQ(rule.reason(), StopReason::kConverged);
  EXPECT_TRUE(rule.afterTest(true, 1200, 80));
  EXPECT_EQ(rule.reason(), StopReason::kTargetError);
}

TEST(StopRule, ATestEndsAtTheLimits) {
  BakeParams params = limits(10, 1, 2000, 5);
  params.target_error = 0.01;
  StopRule rule(params);
  EXPECT_TRUE(rule.afterLaunch(400, 1));
  EXPECT_FALSE(rule.endsAfter(7));
  EXPECT_EQ(rule.mostTestRays(400), 1600u) << "what the limit leaves";
  EXPECT_EQ(rule.mostTestRays(1900), 476u) << "but no less than a brief test";
  EXPECT_TRUE(rule.afterTestLaunch(4.9));
  EXPECT_FALSE(rule.afterTestLaunch(5));
  EXPECT_TRUE(rule.afterTest(false, 400, 100));
  EXPECT_EQ(rule.reason(), StopReason::kTimeLimit);
}

/// It says where the error stands, though there is no time left, and may even find that it is small enough.
TEST(StopRule, ATestAfterALimitIsBrief) {
  for (const bool reached : {false, true}) {
    BakeParams params = limits(10, 1, 1000, 5);
    params.target_error = 0.01;
    StopRule rule(params);
    EXPECT_TRUE(rule.afterLaunch(400, 1));
    EXPECT_FALSE(rule.endsAfter(7));
    EXPECT_FALSE(rule.afterTest(false, 400, 1'000'000));
    EXPECT_FALSE(rule.afterLaunch(1000, 6));
    EXPECT_TRUE(rule.endsAfter(7));
    EXPECT_TRUE(rule.testDue(1000)) << "though the last was dear";
    EXPECT_EQ(rule.mostTestRays(1000), 251u);
    EXPECT_TRUE(rule.afterTestLaunch(7)) << "the time was up before";
    EXPECT_TRUE(rule.afterTest(reached, 1000, 251));
    EXPECT_EQ(rule.reason(), reached ? StopReason::kTargetError : StopReason::kTimeLimit);
  }
}

}  // namespace
}  // namespace sightline
