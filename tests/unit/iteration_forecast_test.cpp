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
  double passed, left, forecast, from, to;
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
    const auto due = [&](double chance) {
      return forecast.due(kThreshold, chance) * forecast.secondsEach(kThreshold);
    };
    watch.add(passed, due(0.5));
    moments.push_back({passed, bake.seconds() - passed, due(0.5), due(0.1), due(0.9),
                       forecast.foretells(kThreshold), watch.standsStill()});
  }
  moments.pop_back();
  return moments;
}

/// Median factor between forecast and truth over the second half of the bake's time; 2 for both half and
/// double. Where nothing is foretold, there is none.
double medianFactor(const RecordedBake& bake) {
  std::vector<double> factors;
  for (const Moment& m : replay(bake)) {
    if (m.passed < bake.seconds() / 2 || !m.foretells) continue;
    factors.push_back(std::max(m.forecast / m.left, m.left / m.forecast));
  }
  std::sort(factors.begin(), factors.end());
  return (factors.at((factors.size() - 1) / 2) + factors.at(factors.size() / 2)) / 2;
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
    EXPECT_GT(ratios[30], 0.5) << scale;
    EXPECT_LT(ratios[30], 2) << scale;
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
  EXPECT_EQ(forecast.secondsEach(kThreshold), 0);
  forecast.add(1000, 30);
  EXPECT_EQ(forecast.secondsEach(kThreshold), 30);
  forecast.add(9, 2);
  EXPECT_EQ(forecast.secondsEach(kThreshold), 2) << "the first finds most, and takes longest";
  for (int i = 0; i < 5; ++i) forecast.add(100, 3);
  forecast.add(100, 5);
  EXPECT_EQ(forecast.secondsEach(kThreshold), 4);
  forecast.add(100'000, 9);
  EXPECT_EQ(forecast.secondsEach(kThreshold), 7);
}

TEST(IterationForecast, TakesTheShortestWhereTheyForetellNothing) {
  IterationForecast forecast;
  for (const double seconds : {5.0, 22.0, 14.0}) forecast.add(50'000, seconds);
  EXPECT_EQ(forecast.secondsEach(kThreshold), 5);
}

// Before (a fall with 1 / iteration of the mean of the last quarter, at the mean rate of rays) and now:
//   hairline room 5.2, 1.3; smaller hairline room 4.2, 1.7; wide gaps 2.1, 2.0; city street 2.1, 2.1; the
//   geometric mean of the four 3.1, 1.7. Of the canyon, 15 hours were foretold to a bake of 19 s: now only
//   what is left at least, until the last but one iteration.
TEST(IterationForecast, ForetellsRecordedBakes) {
  double product = 1;
  for (const char* name : {"hairline room", "smaller hairline room", "wide gaps", "city street"}) {
    const double factor = medianFactor(recorded(name));
    EXPECT_LT(factor, 2.3) << name;
    product *= factor;
  }
  EXPECT_LT(medianFactor(recorded("hairline room")), 1.5);
  EXPECT_LT(std::pow(product, 0.25), 1.8);
}

/// What stands there as the least is less, what stands there as a range is right most times, and what stands
/// there alone is not off by more than the bake is long.
TEST(IterationForecast, SaysHowSureItIs) {
  double ranges = 0, right = 0;
  for (const RecordedBake& bake : kRecordedBakes) {
    SCOPED_TRACE(bake.name);
    for (const Moment& m : replay(bake)) {
      SCOPED_TRACE(m.passed);
      if (!m.foretells) {
        EXPECT_LE(m.forecast, m.left);
      } else if (m.stands_still) {
        ++ranges;
        EXPECT_LE(m.from, m.forecast);
        EXPECT_LE(m.forecast, m.to);
        right += m.from <= m.left && m.left <= m.to ? 1 : 0;
      } else {
        EXPECT_LT(std::abs(m.forecast - m.left), 0.4 * bake.seconds());
      }
    }
  }
  ASSERT_GT(ranges, 20);
  EXPECT_GT(right / ranges, 0.6) << ranges;
}

TEST(FinishWatch, TellsAForecastThatStandsStill) {
  FinishWatch comes_true, stands_still, grows, fell;
  for (double now = 1; now < 100; ++now) {
    comes_true.add(now, 100 - now);
    stands_still.add(now, 20);
    grows.add(now, now);
    fell.add(now, now < 50 ? 100 : 100 - now);
    EXPECT_FALSE(comes_true.standsStill()) << now;
    EXPECT_EQ(stands_still.standsStill(), now > 1) << now;
    EXPECT_EQ(grows.standsStill(), now > 1) << now;
  }
  EXPECT_FALSE(fell.standsStill()) << "what was long ago is forgotten";
  EXPECT_FALSE(FinishWatch().standsStill());
}

}  // namespace
}  // namespace sightline
