// Methods at equal budgets: what is counted must agree with what single bakes and measurements say.
#include "core/compare/comparison.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "core/measure/missing_rays.h"
#include "tests/support/bake_scene.h"

namespace sightline {
namespace {

/// A small town from one cell, on the cpu device.
class ComparisonTest : public testing::Test {
 protected:
  ComparisonTest() {
    options_.methods = {Method::kRandom, Method::kGvspp};
    options_.params = testing_support::quickParams();
    options_.params.n_rand = 20'000;
    options_.params.threshold = 0;
    options_.params.max_rays = 400'000;
    options_.params.batch_rays = 8192;
    options_.repeats = 2;
    options_.points = 3;
    options_.missing_rays = 50'000;
    options_.measure.views = 8;
    options_.measure.resolution = 48;
  }

  CellComparison compare(const CompareOptions& options) {
    const std::vector<Device*> devices(options.methods.size(), device_.get());
    return compareCell(devices, scene_, cell_, 0, options);
  }

  const Scene scene_ = generateScene("city", 8000, 1);
  const ViewCell cell_ = generateCells("city", 8000, 1).front();
  const Bvh bvh_ = buildBvh(scene_.positions, scene_.triangles);
  const std::unique_ptr<Device> device_ = makeDevice("cpu", scene_, bvh_);
  CompareOptions options_;
};

TEST_F(ComparisonTest, TheWholeBudgetIsWhatASingleBakeGives) {
  const CellComparison comparison = compare(options_);
  ASSERT_EQ(comparison.runs.size(), 4u);
  for (const MethodRun& run : comparison.runs) {
    BakeParams params = options_.params;
    params.method = run.method;
    params.seed = run.seed;
    params.validation_rays = 0;
    // The last state within the budget: a bake that stops there has that very set.
    params.max_rays = 0;
    const CurvePoint& state = run.points.back().state;
    for (const uint64_t rays : state.rays) params.max_rays += rays;
    const CellPvs pvs = bakeCell(*device_, scene_, cell_, 0, params);
    EXPECT_EQ(pvs.triangles.size(), state.size + pvs.stats.contained_triangles);

    const std::vector<RankedSet> sets = {rankedSet(pvs.triangles, uint32_t(scene_.triangles.size()))};
    EXPECT_EQ(measureCell(*device_, cell_, 0, sets, options_.measure)[0].by_prefix[0],
              run.points.back().error);
    EXPECT_LE(params.max_rays, options_.params.max_rays);
  }
}

TEST_F(ComparisonTest, MoreBudgetIsNeverWorse) {
  for (const MethodRun& run : compare(options_).runs) {
    ASSERT_EQ(run.points.size(), 3u);
    EXPECT_EQ(run.points[0].budget_share, 0.25);
    EXPECT_EQ(run.points[2].budget_share, 1);
    for (size_t p = 1; p < run.points.size(); ++p) {
      EXPECT_GE(run.points[p].state.size, run.points[p - 1].state.size);
      EXPECT_LE(run.points[p].error.wrong, run.points[p - 1].error.wrong);
      EXPECT_LE(run.points[p].missing_share, run.points[p - 1].missing_share);
    }
    ASSERT_EQ(run.curve.size(), run.missing_shares.size());
    EXPECT_GT(run.curve.size(), 5u);
    EXPECT_TRUE(std::is_sorted(run.missing_shares.rbegin(), run.missing_shares.rend()));
    EXPECT_EQ(run.curve.back(), run.points.back().state);
    EXPECT_GT(run.points.front().error.wrong, 0u);
  }
}

TEST_F(ComparisonTest, IsTheSameOnEveryRunButForTheSeconds) {
  const CellComparison first = compare(options_), second = compare(options_);
  for (size_t r = 0; r < first.runs.size(); ++r) {
    for (size_t p = 0; p < first.runs[r].points.size(); ++p) {
      const ComparePoint &a = first.runs[r].points[p], &b = second.runs[r].points[p];
      EXPECT_EQ(a.state.rays, b.state.rays);
      EXPECT_EQ(a.state.size, b.state.size);
      EXPECT_EQ(a.missing_share, b.missing_share);
      EXPECT_EQ(a.error, b.error);
    }
  }
  EXPECT_NE(first.runs[0].points.back().error, first.runs[1].points.back().error)
      << "seeds give the same rays";
}

TEST_F(ComparisonTest, MissingRaysAreThoseOfABakesValidation) {
  BakeParams params = options_.params;
  params.validation_rays = 60'000;
  params.max_rays = 25'000;  // so few that some are missing
  const CellPvs pvs = bakeCell(*device_, scene_, cell_, 0, params);
  ASSERT_GT(pvs.stats.missing_rays, 0u);
  const std::vector<RankedSet> sets = {rankedSet(pvs.triangles, uint32_t(scene_.triangles.size()))};
  EXPECT_EQ(countMissingRays(*device_, cell_, 0, params.seed, 60'000, sets),
            (std::vector<std::vector<uint64_t>>{{pvs.stats.missing_rays}}));
}

TEST_F(ComparisonTest, SummariesAverageOverCellsAndSpreadOverSeeds) {
  CellComparison cell{cell_, {}};
  for (const uint64_t pixels : {10, 30}) {  // two seeds
    MethodRun run;
    ComparePoint point;
    point.error.views = 10;
    point.error.wrong = pixels * 10;
    point.error.max_wrong = uint32_t(pixels * 3);
    point.state.size = 50;
    run.points = {point};
    cell.runs.push_back(run);
  }
  CellComparison other = cell;
  for (MethodRun& run : other.runs) run.points[0].error.wrong = 0;
  options_.methods = {Method::kGvspp};
  const auto summaries = summarize(std::vector{cell, other}, options_, 100, 0);
  ASSERT_EQ(summaries.size(), 1u);
  EXPECT_EQ(summaries[0].average_wrong.low, 5);
  EXPECT_EQ(summaries[0].average_wrong.median, 10);
  EXPECT_EQ(summaries[0].average_wrong.high, 15);
  EXPECT_EQ(summaries[0].mean_max_wrong.high, 90);
  EXPECT_EQ(summaries[0].max_wrong, 90u);
  EXPECT_EQ(summaries[0].pvs_share.median, 0.5);
}

TEST_F(ComparisonTest, OptionsOutOfRangeAreRefused) {
  const auto refused = [&](auto&& spoil) {
    CompareOptions options = options_;
    spoil(options);
    EXPECT_THROW(checkOptions(options), Error);
  };
  checkOptions(options_);
  refused([](CompareOptions& o) { o.methods.clear(); });
  refused([](CompareOptions& o) { o.params.max_rays = 0; });
  refused([](CompareOptions& o) { o.repeats = 0; });
  refused([](CompareOptions& o) { o.points = 41; });
  refused([](CompareOptions& o) { o.missing_rays = 0; });
  refused([](CompareOptions& o) { o.measure.views = 0; });
}

}  // namespace
}  // namespace sightline
