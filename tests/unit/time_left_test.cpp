// What a bake says about the time it still takes.
#include <gtest/gtest.h>

#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "tests/support/bake_scene.h"

namespace sightline {
namespace {

/// All that a bake of a generated city's cell reports: few random rays an iteration, so there are many.
std::vector<BakeProgress> progressOf(BakeParams params) {
  params.n_rand = 2'000;
  params.validation_rays = 50'000;
  params.batch_rays = 4096;
  const Scene scene = generateScene("city", 5'000, 1);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles, {});
  const auto device = makeDevice("cpu", scene, bvh, {});
  std::vector<BakeProgress> reports;
  BakeHooks hooks;
  hooks.progress = [&](const BakeProgress& progress) { reports.push_back(progress); };
  bakeCell(*device, scene, generateCells("city", 5'000, 1).back(), 0, params, hooks);
  return reports;
}

TEST(TimeLeft, IsABoundFirstThenAnEstimateOrARange) {
  BakeParams params;
  params.threshold = 2;
  bool bounds = false, estimates = false;
  for (const BakeProgress& p : progressOf(params)) {
    SCOPED_TRACE(testing::Message() << "iteration " << p.iteration << " stage " << p.stage);
    if (p.iteration == 1 && p.stage == kStageRandom) {
      EXPECT_LT(p.seconds_left, 0) << "nobody knows";
      continue;
    }
    EXPECT_GE(p.seconds_left, 0);
    if (p.validating) {
      EXPECT_FALSE(p.at_least);
      EXPECT_EQ(p.seconds_left_to, 0);
    } else if (p.iteration <= 4) {
      EXPECT_TRUE(p.at_least) << "three complete iterations foretell nothing";
      bounds = true;
    } else if (p.seconds_left_to > 0) {
      EXPECT_FALSE(p.at_least);
      EXPECT_LE(p.seconds_left_from, p.seconds_left);
      EXPECT_LE(p.seconds_left, p.seconds_left_to);
      estimates = true;
    } else {
      estimates = true;
    }
  }
  EXPECT_TRUE(bounds);
  EXPECT_TRUE(estimates) << "no bake of many iterations";
}

/// Without a threshold the limit is all there is, and it is no guess.
TEST(TimeLeft, OfALimitIsSure) {
  BakeParams params;
  params.threshold = 0;
  params.max_rays = 300'000;
  for (const BakeProgress& p : progressOf(params)) {
    EXPECT_FALSE(p.at_least);
    EXPECT_EQ(p.seconds_left_to, 0);
    if (p.validating || p.seconds_left < 0) continue;
    const double rate = double(p.rays) / p.seconds;
    const double rays_left = std::max(0.0, 300'000.0 - double(p.rays)) + 50'000;
    EXPECT_NEAR(p.seconds_left, rays_left / rate, 1e-6 + 1e-6 * p.seconds_left);
  }
}

}  // namespace
}  // namespace sightline
