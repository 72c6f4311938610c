// Scenes whose pixel error is known by construction.
#include "core/measure/pixel_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/bake_cell.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::bakeOn;
using testing_support::idRange;
using testing_support::SceneOfBoxes;

std::vector<uint32_t> without(std::vector<uint32_t> ids, std::vector<uint32_t> gone) {
  std::erase_if(ids, [&](uint32_t id) { return std::find(gone.begin(), gone.end(), id) != gone.end(); });
  return ids;
}

MeasureOptions lookAt(uint32_t views, uint32_t resolution) {
  MeasureOptions options;
  options.views = views;
  options.resolution = resolution;
  return options;
}

class PixelErrorTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (std::string(GetParam()) == "vulkan") SL_SKIP_WITHOUT_VULKAN();
  }
  PixelError measure(const Scene& scene, const ViewCell& cell, const std::vector<uint32_t>& set,
                     const MeasureOptions& options) const {
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    const auto device = makeDevice(GetParam(), scene, bvh);
    const std::vector<RankedSet> sets = {rankedSet(set, uint32_t(scene.triangles.size()))};
    return measureCell(*device, cell, 0, sets, options).front().by_prefix.front();
  }
};

/// A tiny flat cell that looks at a wall of 16 by 16 squares from a distance of 8: at 16 by 16 pixels and 90
/// degrees a square is a pixel.
///
///   cell  |>   |#
///         |    |#  wall of squares, z = 8
class Mosaic {
 public:
  Mosaic() {
    SceneOfBoxes boxes;
    for (int row = 0; row < 16; ++row) {
      for (int column = 0; column < 16; ++column) {
        boxes.addRectangle({float(column - 8), float(row - 8), 8}, {1, 0, 0}, {0, 1, 0});
      }
    }
    scene = boxes.finish();
  }
  /// All squares but these (row, column).
  std::vector<uint32_t> setWithout(const std::vector<std::pair<int, int>>& squares) const {
    std::vector<uint32_t> gone;
    for (const auto& [row, column] : squares) {
      gone.push_back(uint32_t(2 * (row * 16 + column)));
      gone.push_back(gone.back() + 1);
    }
    return without(idRange(0, 512), gone);
  }
  Scene scene;
  const ViewCell cell{"dot", {0, 0, 0}, {0.02, 0.02, 0}};
};

TEST_P(PixelErrorTest, OfACompleteSetIsNothing) {
  const Mosaic mosaic;
  const PixelError error = measure(mosaic.scene, mosaic.cell, idRange(0, 512), lookAt(20, 16));
  EXPECT_EQ(error.views, 20u);
  EXPECT_EQ(error.pixels, 20u * 256);
  EXPECT_EQ(error.wrong, 0u);
  EXPECT_EQ(error.regions, 0u);
  EXPECT_EQ(error.max_wrong, 0u);
  EXPECT_EQ(error.wrongShare(), 0);
}

/// Each square that is not in the set is one wrong pixel of every view.
TEST_P(PixelErrorTest, CountsTheSquaresOfAMosaic) {
  const Mosaic mosaic;
  struct Case {
    std::vector<std::pair<int, int>> gone;
    uint32_t regions, largest;
  };
  for (const Case& c : {Case{{{3, 4}}, 1, 1}, Case{{{0, 0}, {15, 15}, {0, 15}, {15, 0}}, 4, 1},
                        Case{{{2, 2}, {2, 3}, {3, 2}, {10, 9}, {11, 10}, {12, 11}, {13, 10}, {12, 9}}, 2, 5},
                        Case{{{5, 5}, {6, 6}, {7, 7}, {8, 8}}, 1, 4}}) {
    const PixelError error = measure(mosaic.scene, mosaic.cell, mosaic.setWithout(c.gone), lookAt(10, 16));
    EXPECT_EQ(error.averageWrong(), double(c.gone.size()));
    EXPECT_EQ(error.max_wrong, c.gone.size());
    EXPECT_EQ(error.averageRegions(), c.regions);
    EXPECT_EQ(error.max_regions, c.regions);
    EXPECT_EQ(error.largest_region, c.largest);
    EXPECT_EQ(error.wrongShare(), double(c.gone.size()) / 256);
  }
}

/// Finer pixels: a square is 4 by 4 of them, up to those on its rim, which the cell's size can shift.
TEST_P(PixelErrorTest, GrowsWithTheResolution) {
  const Mosaic mosaic;
  const PixelError error =
      measure(mosaic.scene, mosaic.cell, mosaic.setWithout({{3, 4}, {9, 9}}), lookAt(10, 64));
  EXPECT_EQ(error.averageWrong(), 32);
  EXPECT_EQ(error.averageRegions(), 2);
  EXPECT_EQ(error.largest_region, 16u);
}

/// What shows only through the back face of a box, or straight up, must be in the set: walls around the cell
/// in all directions, one of them missing, cost a sixth of all that is seen, on average.
TEST_P(PixelErrorTest, OfABoxCountsEverySideOfTheWorld) {
  SceneOfBoxes boxes;
  boxes.addBox({-1000, -1000, -1000}, {1000, 1000, 1000});
  const Scene scene = boxes.finish();
  const ViewCell cell{"box", {0, 0, 0}, {1, 1, 1}, {0, 0, 0}};
  for (uint32_t wall = 0; wall < 6; ++wall) {
    const auto set = without(idRange(0, 12), {2 * wall, 2 * wall + 1});
    const PixelError error = measure(scene, cell, set, lookAt(600, 16));
    EXPECT_NEAR(error.wrongShare(), 1.0 / 6, 0.01) << "wall " << wall;
    EXPECT_GT(error.max_wrong, 200u) << "some view looks straight at wall " << wall;
  }
}

/// A small thing behind the cell, seen from its back face only: a shield stands before the others.
TEST_P(PixelErrorTest, SeesWhatOnlyTheBackFaceSees) {
  SceneOfBoxes boxes;
  boxes.addRectangle({-50, -50, -0.51f}, {100, 0, 0}, {0, 99.5f, 0});  // below 49.5, close to the back face
  const uint32_t sign = boxes.addRectangle({-1, -1, -0.505f}, {2, 0, 0}, {0, 2, 0});
  const Scene scene = boxes.finish();
  const PixelError error = measure(scene, {"box", {0, 0, 0}, {1, 1, 1}},
                                   without(idRange(0, 4), {sign, sign + 1}), lookAt(200, 16));
  EXPECT_GT(error.wrong, 0u);
  EXPECT_EQ(measure(scene, {"box", {0, 0, 0}, {1, 1, 1}}, idRange(0, 4), lookAt(200, 16)).wrong, 0u);
}

INSTANTIATE_TEST_SUITE_P(All, PixelErrorTest, testing::Values("cpu", "opencl", "vulkan"),
                         [](const auto& device) { return std::string(device.param); });

/// Several sets and all prefixes of one in a single pass give what each gives alone.
TEST(PixelErrors, OfManySetsAreThoseOfEach) {
  const Mosaic mosaic;
  const Bvh bvh = buildBvh(mosaic.scene.positions, mosaic.scene.triangles);
  const auto device = makeDevice("cpu", mosaic.scene, bvh);
  std::vector<uint32_t> order = idRange(0, 512);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  RankedSet ranked{std::vector<uint32_t>(512, kNoRank), {0, 1, 100, 100, 300, 511, 512, 4000}};
  for (uint32_t i = 0; i < 512; ++i) ranked.rank[order[i]] = i;
  const std::vector<uint32_t> other = mosaic.setWithout({{1, 1}, {2, 2}});
  const std::vector<RankedSet> sets = {ranked, rankedSet(other, 512)};
  MeasureOptions options = lookAt(30, 21);
  options.worst_views = 2;
  const std::vector<SetError> errors = measureCell(*device, mosaic.cell, 0, sets, options);
  ASSERT_EQ(errors.size(), 2u);
  ASSERT_EQ(errors[0].by_prefix.size(), ranked.prefixes.size());
  for (size_t k = 0; k < ranked.prefixes.size(); ++k) {
    const size_t size = std::min<size_t>(512, ranked.prefixes[k]);
    const std::vector<RankedSet> alone = {rankedSet(std::span(order).first(size), 512)};
    const SetError expected = measureCell(*device, mosaic.cell, 0, alone, options).front();
    EXPECT_EQ(errors[0].by_prefix[k], expected.by_prefix.front()) << "prefix " << k;
  }
  EXPECT_EQ(errors[0].by_prefix[0].wrong, 30u * 21 * 21);
  EXPECT_EQ(errors[0].by_prefix[6].wrong, 0u);
  EXPECT_TRUE(errors[0].worst_views.empty());
  EXPECT_GT(errors[1].by_prefix[0].wrong, 0u);
  ASSERT_EQ(errors[1].worst_views.size(), 2u);
  EXPECT_EQ(errors[1].worst_views[0], errors[1].by_prefix[0].worst_view);
}

/// Contained triangles count from the first prefix on, the others in the order of the list.
TEST(PixelErrors, RankTheTrianglesOfADevicesList) {
  const auto entry = [](uint32_t triangle, uint32_t stage) {
    return PvsEntry{uvec4(0, 0, 0, triangle), uvec4(0, 0, 0, stage)};
  };
  const std::vector<PvsEntry> list = {entry(4, kStageRandom), entry(2, kStageBorder), entry(0, kStageReverse),
                                      entry(3, kStageContained)};
  const RankedSet set = rankedSet(list, 6, {0, 1, 3});
  EXPECT_EQ(set.rank, (std::vector<uint32_t>{2, kNoRank, 1, 0, 0, kNoRank}));
  EXPECT_EQ(missingLevels(set), (std::vector<uint16_t>{2, 3, 2, 1, 1, 3}));
  EXPECT_THROW(rankedSet(list, 4, {0}), Error);
  EXPECT_THROW(missingLevels(RankedSet{{0, 1}, {}}), Error);
  EXPECT_THROW(missingLevels(RankedSet{{0, 1}, {2, 1}}), Error);
}

/// The same for any number of threads, and from OpenCL as from the host.
TEST(PixelErrors, DoNotDependOnThreadsOrDevice) {
  std::mt19937 random(11);
  SceneOfBoxes boxes;
  for (int i = 0; i < 150; ++i) {
    const glm::vec3 low(float(random() % 40) - 20, float(random() % 20), float(random() % 40) + 3);
    boxes.addBox(low, low + glm::vec3(1 + float(random() % 3), 1 + float(random() % 5), 1));
  }
  const Scene scene = boxes.finish();
  const ViewCell cell{"box", {0, 2, 0}, {2, 1, 1}};
  const uint32_t triangles = uint32_t(scene.triangles.size());
  std::vector<uint32_t> some;
  for (uint32_t id = 0; id < triangles; ++id) {
    if (random() % 20 != 0) some.push_back(id);
  }
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const std::vector<RankedSet> sets = {rankedSet(some, triangles)};
  std::vector<PixelError> results;
  for (const int threads : {1, 2, 5}) {
    DeviceOptions options;
    options.threads = threads;
    results.push_back(measureCell(*makeDevice("cpu", scene, bvh, options), cell, 2, sets, lookAt(60, 50))
                          .front()
                          .by_prefix[0]);
  }
  results.push_back(
      measureCell(*makeDevice("opencl", scene, bvh), cell, 2, sets, lookAt(60, 50)).front().by_prefix[0]);
  EXPECT_GT(results[0].regions, 100u);
  for (const PixelError& result : results) EXPECT_EQ(result, results[0]);
}

TEST(PixelErrors, OfACellEndWhenStopped) {
  const Mosaic mosaic;
  const Bvh bvh = buildBvh(mosaic.scene.positions, mosaic.scene.triangles);
  const auto device = makeDevice("cpu", mosaic.scene, bvh);
  const std::vector<RankedSet> sets = {rankedSet(idRange(0, 512), 512)};
  std::atomic<bool> stop = false;
  uint32_t calls = 0, seen = 0;
  const auto progress = [&](const MeasureProgress& p) {
    ++calls;
    seen = p.views_done;
    stop = true;
  };
  EXPECT_THROW(measureCell(*device, mosaic.cell, 0, sets, lookAt(2000, 200), progress, &stop), Interrupted);
  EXPECT_EQ(calls, 1u);
  EXPECT_LT(seen, 2000u);
}

TEST(PixelErrors, OfASceneAreAveragesAndLargest) {
  PixelError a{10, 1000, 20, 30, 9, 1, 5, 4}, b{10, 1000, 40, 10, 7, 2, 3, 6};
  const std::vector<PixelError> cells = {a, b};
  const SceneError scene = summarize(cells);
  EXPECT_EQ(scene.average_wrong, 3);
  EXPECT_EQ(scene.average_regions, 2);
  EXPECT_EQ(scene.wrong_share, 0.03);
  EXPECT_EQ(scene.max_wrong, 9u);
  EXPECT_EQ(scene.mean_max_wrong, 8);
  EXPECT_EQ(scene.largest_region, 6u);
  EXPECT_EQ(scene.mean_largest_region, 5);
  EXPECT_EQ(summarize(std::span<const PixelError>()).max_wrong, 0u);
}

TEST(PixelErrors, OptionsOutOfRangeAreRefused) {
  MeasureOptions options;
  options.resolution = 4097;
  EXPECT_THROW(checkOptions(options), Error);
  options.resolution = 10;
  options.fov = 180;
  EXPECT_THROW(checkOptions(options), Error);
  options.fov = 90;
  options.views = 0;
  EXPECT_THROW(checkOptions(options), Error);
}

}  // namespace
}  // namespace sightline
