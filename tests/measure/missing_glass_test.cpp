// A ray that sees glass outside a set misses, whatever it ends on.
#include <gtest/gtest.h>

#include "core/device/cpu/cpu_device.h"
#include "core/measure/missing_rays.h"
#include "core/measure/pixel_error.h"
#include "tests/support/make_cell.h"

namespace sightline {
namespace {

RankedSet setOf(const std::vector<uint32_t>& triangles) {
  return rankedSet(triangles, 2);
}

TEST(MissingRays, CountGlassThatIsNotInTheSet) {
  Scene scene;  // a pane of glass before a wall
  scene.positions = {{-50, -50, -4}, {50, -50, -4}, {0, 90, -4}, {-50, -50, -9}, {50, -50, -9}, {0, 90, -9}};
  scene.triangles = {{0, 1, 2}, {3, 4, 5}};
  scene.objects = {{"all", 0, 2}};
  scene.surfaces.words = {kSurfaceGlass, 0u};
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeCpuDevice(scene, bvh, {});
  const ViewCell cell = testing_support::makeCell({0, 0, 0}, {1, 1, 1});
  const RankedSet sets[] = {setOf({0, 1}), setOf({1}), setOf({0})};
  const auto missing = countMissingRays(*device, cell, 0, 1, 10'000, sets);
  EXPECT_EQ(missing[0].back(), 0u);
  EXPECT_GT(missing[1].back(), 1'000u);  // rays through the pane
  EXPECT_GT(missing[2].back(), 1'000u);  // rays that end on the wall
  MeasureOptions options;
  options.views = 16;
  options.resolution = 64;
  const std::vector<SetError> errors = measureCell(*device, cell, 0, sets, options);
  EXPECT_EQ(errors[0].by_prefix.back().wrong, 0u);
  EXPECT_GT(errors[1].by_prefix.back().wrong, 1'000u);
  EXPECT_GT(errors[2].by_prefix.back().wrong, 1'000u);
}

}  // namespace
}  // namespace sightline
