// Multiqueries against every choice of nodes there is.
#include "core/draw/multi_query.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

TEST(MultiQuery, StillHiddenIsTheFormula) {
  for (uint32_t n = 0; n < 100; ++n) EXPECT_NEAR(stillHidden(n), 0.99 - 0.7 * std::exp(-double(n)), 1e-15);
  EXPECT_DOUBLE_EQ(stillHidden(0), 0.99 - 0.7);
  EXPECT_EQ(stillHidden(~0u), 0.99);
}

TEST(MultiQuery, NoChoiceOfNodesIsBetter) {
  testing_support::Random random(5);
  for (int round = 0; round < 300; ++round) {
    std::vector<double> hidden(1 + random.pick(12));
    for (double& h : hidden) h = round % 3 == 0 ? stillHidden(random.pick(8)) : random.unit();
    std::sort(hidden.begin(), hidden.end(), std::greater<>());
    double best = 0;
    for (uint32_t set = 1; set < 1u << hidden.size(); ++set) {
      double all = 1;
      uint32_t count = 0;
      for (size_t i = 0; i < hidden.size(); ++i) {
        if ((set >> i & 1) == 0) continue;
        all *= hidden[i];
        ++count;
      }
      best = std::max(best, multiQueryValue(count, all));
    }
    const uint32_t size = multiQuerySize(hidden);
    double all = 1;
    for (uint32_t i = 0; i < size; ++i) all *= hidden[i];
    EXPECT_EQ(multiQueryValue(size, all), best) << "round " << round;
    for (uint32_t fewer = 1; fewer < size; ++fewer) {  // of equal ones the fewest
      double product = 1;
      for (uint32_t i = 0; i < fewer; ++i) product *= hidden[i];
      EXPECT_LT(multiQueryValue(fewer, product), best);
    }
  }
}

TEST(MultiQuery, WhatIsNotKnownIsAskedAboutAlone) {
  EXPECT_EQ(multiQuerySize(std::vector<double>(20, stillHidden(0))), 1u);
  EXPECT_EQ(multiQuerySize(std::vector<double>(20, stillHidden(1))), 3u);
  EXPECT_EQ(multiQuerySize(std::vector<double>(40, stillHidden(50))), 11u);
  EXPECT_EQ(multiQuerySize(std::vector<double>{1, 1, 1, 1}), 4u);
}

}  // namespace
}  // namespace sightline
