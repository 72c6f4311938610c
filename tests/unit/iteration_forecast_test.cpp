#include "core/gvs/iteration_forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/gvs/finish_watch.h"
#include "tests/unit/recorded_bakes.h"

namespace sightline {
namespace {

using testing_support::kRecordedBakes;
using testing_support::RecordedBake;
using testing_support::RecordedIteration;

constexpr uint32_t kThreshold = 10;

/// After `iterations` that found scale / i.
IterationForecast after(uint32_t iterations, uint32_t scale) {
  IterationForecast forecast;
  for (uint32_t i = 1; i <= iterations; ++i) forecast.add(scale / i, 1);
  return forecast;
}

/// A forecast of the seconds left, next to the truth.
struct Moment {
  double passed, left, forecast;
  bool foretells, stands_still;
};

/// What was forecast after each iteration but the last.
std::vector<Moment> replay(const RecordedBake& bake) {
  std::vector<Moment> moments;
  IterationForecast forecast;
  FinishWatch watch;
  double passed = 0;
  for (const RecordedIteration& iteration : bake.iterations) {
    passed += iteration.seconds;
    forecast.add(iteration.found, iteration.seconds);
    const double left = forecast.due(kThreshold) * forecast.secondsEach();
    watch.add(passed, left);
    moments.push_back(
        {passed, bake.seconds() - passed, left, forecast.foretells(kThreshold), watch.standsStill()});
  }
  moments.pop_back();
  return moments;
}

/// Median of forecast / truth over the second half of the bake's time.
double medianRatio(const RecordedBake& bake) {
  std::vector<double> ratios;
  for (const Moment& m : replay(bake)) {
    if (m.passed >= bake.seconds() / 2) ratios.push_back(m.forecast / m.left);
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios.at(ratios.size() / 2);
}

const RecordedBake& recorded(const std::string& name) {
  return *std::ranges::find(kRecordedBakes, name, &RecordedBake::name);
}

/// What an iteration finds scatters around its mean.
TEST(IterationForecast, FollowsTheFall) {
  for (const double scale : {300.0, 1000.0, 3000.0}) {
    std::vector<double> ratios;
    for (uint32_t seed = 1; seed <= 60; ++seed) {
      std::mt19937 random(seed);
      std::vector<uint32_t> found;
      while (found.size() < 3 || found.back() >= kThreshold)
        found.push_back(uint32_t(std::poisson_distribution<int>(scale / double(found.size() + 1))(random)));
      IterationForecast forecast;
      for (size_t i = 0; i < found.size() / 2; ++i) forecast.add(found[i], 1);
      ratios.push_back(forecast.due(kThreshold) / double(found.size() - found.size() / 2));
    }
    std::sort(ratios.begin(), ratios.end());
    EXPECT_GT(ratios[30], 0.6) << scale;
    EXPECT_LT(ratios[30], 1.7) << scale;
  }
}

/// All that can be found has been: it ends sooner than a fall with 1 / i, which had 80 more iterations to go.
TEST(IterationForecast, SeesAFasterFall) {
  IterationForecast forecast;
  for (uint32_t i = 1; i <= 20; ++i) forecast.add(uint32_t(1000 * std::exp(-0.15 * i)), 1);  // 10 at 31
  EXPECT_GE(forecast.due(kThreshold), 8);
  EXPECT_LE(forecast.due(kThreshold), 30);
}

TEST(IterationForecast, ExpectsAnotherIterationUntilOneIsQuiet) {
  EXPECT_EQ(IterationForecast().due(kThreshold), 1);
  EXPECT_EQ(after(3, 1000).due(kThreshold), 1);
  EXPECT_NEAR(after(12, 120).due(kThreshold), 1, 1.5);
  EXPECT_GE(after(12, 120).due(kThreshold), 1);
  EXPECT_EQ(after(13, 120).due(kThreshold), 0);
}

TEST(IterationForecast, SaysWhatForetellsNothing) {
  EXPECT_FALSE(after(3, 1000).foretells(kThreshold));
  EXPECT_TRUE(after(4, 1000).foretells(kThreshold));
  EXPECT_FALSE(after(7, 20'000).foretells(kThreshold)) << "2857 in the last";
  EXPECT_TRUE(after(8, 20'000).foretells(kThreshold));
  EXPECT_TRUE(after(2, 10).foretells(kThreshold)) << "the last was quiet";
}

/// Much to find, a threshold of 1, a bake without an end: no endless loop, no infinity.
TEST(IterationForecast, StaysFinite) {
  IterationForecast forecast;
  for (int i = 0; i < 50; ++i) forecast.add(4'000'000'000u, 1e6);
  for (const uint32_t threshold : {1u, 10u, 4'000'000'000u}) {
    EXPECT_GE(forecast.due(threshold), 1);
    EXPECT_LE(forecast.due(threshold), 2e6);
  }
}

TEST(IterationForecast, TakesTheSecondsOfTheLastQuarter) {
  IterationForecast forecast;
  EXPECT_EQ(forecast.secondsEach(), 0);
  forecast.add(1000, 30);
  EXPECT_EQ(forecast.secondsEach(), 30);
  forecast.add(100, 2);
  EXPECT_EQ(forecast.secondsEach(), 2) << "the first finds most, and takes longest";
  for (int i = 0; i < 5; ++i) forecast.add(100, 3);
  forecast.add(100, 5);
  EXPECT_EQ(forecast.secondsEach(), 4);
}

// MEASURED
TEST(IterationForecast, ForetellsRecordedBakes) {
  for (const char* name : {"hairline room", "smaller hairline room", "wide gaps", "city street"}) {
    std::string line;
    for (const Moment& m : replay(recorded(name)))
      line += std::to_string(int(m.left)) + ":" + std::to_string(int(m.forecast)) + (m.foretells ? "" : "?") +
              (m.stands_still ? "> " : " ");
    std::printf("%s %f %s\n", name, medianRatio(recorded(name)), line.c_str());
  }
}

}  // namespace
}  // namespace sightline
