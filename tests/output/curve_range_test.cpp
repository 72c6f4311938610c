#include "core/page/curve_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sightline {
namespace {

using Points = std::vector<ChartPoint>;

TEST(CurveRange, HoldsTheLastValueAndBeginsWhereAllHaveBegun) {
  const std::vector<Points> curves = {{{1, 10}, {2, 20}, {3, 30}}, {}, {{2, 5}, {5, 50}}, {{1, 7}}};
  const CurveRange range = rangeOf(curves, {});
  ASSERT_EQ(range.median.size(), 3u);
  const double x[] = {2, 3, 5}, lowest[] = {5, 7, 7}, median[] = {7, 20, 30}, highest[] = {20, 30, 50};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(range.median[i].x, x[i]);
    EXPECT_EQ(range.lowest[i].y, lowest[i]);
    EXPECT_EQ(range.median[i].y, median[i]);
    EXPECT_EQ(range.highest[i].y, highest[i]);
  }
}

TEST(CurveRange, CountsNoPointThatCannotBeDrawn) {
  EXPECT_TRUE(rangeOf({}, {true, true}).median.empty());
  const std::vector<Points> nothing = {{{0, 5}}, {{NAN, 1}, {1, INFINITY}}};
  EXPECT_TRUE(rangeOf(nothing, {true, true}).median.empty());
  const std::vector<Points> curves = {{{0, 5}, {2, 6}}, {{1, 1}, {NAN, 9}, {3, 3}}};
  const CurveRange range = rangeOf(curves, {true, false});
  ASSERT_EQ(range.median.size(), 2u);
  EXPECT_NEAR(range.median[0].y, 4.1309, 1e-4) << "the mean of 6 and, at 2 between 1 and 3, 2.2619";
  EXPECT_EQ(range.median[1].y, 4.5);
}

TEST(CurveRange, IsStraightOnLogarithmicAxes) {
  const std::vector<Points> curves = {{{1, 10}, {100, 1000}}, {{10, 5}}};
  const CurveRange range = rangeOf(curves, {true, true});
  ASSERT_EQ(range.highest.size(), 2u);
  EXPECT_NEAR(range.highest[0].y, 100, 1e-9);
  EXPECT_EQ(range.highest[1].y, 1000);
  EXPECT_EQ(range.lowest[1].y, 5);
}

/// Against the definition, point by point, on axes of every kind.
TEST(CurveRange, IsWhatSortingAllValuesGives) {
  for (uint32_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto number = [&](uint32_t most) { return double(random() % most + 1); };
    std::vector<Points> curves(1 + random() % 12);
    double begin = 0, end = 0;
    for (Points& curve : curves) {
      double x = 0, y = 0;
      for (auto i = 1 + random() % 30; i > 0; --i) curve.push_back({x += number(9), y += number(99)});
      begin = std::max(begin, curve.front().x);
      end = std::max(end, curve.back().x);
    }
    const size_t most = 2 + random() % 40;
    const ChartAxes axes = {seed % 2 == 0, seed % 4 < 2};
    const auto place = [&](double x) { return axes.log_x ? std::log(x) : x; };
    const auto height = [&](double y) { return axes.log_y ? std::log(y) : y; };
    const CurveRange range = rangeOf(curves, axes, most);
    ASSERT_LE(range.median.size(), most);
    EXPECT_EQ(range.median.front().x, begin);
    EXPECT_EQ(range.median.back().x, end);
    for (size_t i = 0; i < range.median.size(); ++i) {
      const double x = range.median[i].x;
      if (i > 0) {
        EXPECT_GT(x, range.median[i - 1].x);
      }
      std::vector<double> values;
      for (const Points& curve : curves) {
        size_t next = 0;
        while (next < curve.size() && curve[next].x <= x) ++next;
        double value = height(curve[next - 1].y);
        if (next < curve.size()) {
          const double part =
              (place(x) - place(curve[next - 1].x)) / (place(curve[next].x) - place(curve[next - 1].x));
          value += part * (height(curve[next].y) - value);
        }
        values.push_back(axes.log_y ? std::exp(value) : value);
      }
      std::sort(values.begin(), values.end());
      const size_t n = values.size();
      EXPECT_NEAR(range.lowest[i].y, values.front(), 1e-9 * values.front());
      EXPECT_NEAR(range.highest[i].y, values.back(), 1e-9 * values.back());
      EXPECT_NEAR(range.median[i].y, (values[(n - 1) / 2] + values[n / 2]) / 2, 1e-9 * values.back());
    }
  }
}

}  // namespace
}  // namespace sightline
