// Embree as a peer: it answers rays, before the same judge, and bakes nothing.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/crosscheck/crosscheck.h"
#include "core/device/embree/embree_device.h"
#include "core/device/registry/make_device.h"
#include "tests/judge/judge_cases.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

#define SL_SKIP_WITHOUT_EMBREE() \
  if (!embreeDeviceInfo().unusable.empty()) GTEST_SKIP() << embreeDeviceInfo().unusable

TEST(Embree, FindsWhatTheJudgeFinds) {
  SL_SKIP_WITHOUT_EMBREE();
  judge_test::Random random(4);
  const Scene scene = judge_test::soup(random, 500, 1, 1);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  const auto embree = makeDevice("embree", scene, bvh);
  std::vector<Ray> rays;
  for (int i = 0; i < 5000; ++i) rays.push_back({vec4(random.point(2), 0), vec4(random.point(1), 0)});
  rays.push_back({vec4(0), vec4(0)});
  std::vector<Hit> hits(rays.size());
  embree->traceRays(rays, hits);
  EXPECT_EQ(hits.back().triangle, kNoTriangle) << "it has no direction";
  size_t right = 0, met = 0;
  for (size_t i = 0; i + 1 < rays.size(); ++i) {
    const ExactHit exact = judge.nearest(judgeRay(rays[i]));
    const Verdict verdict = rule(judge, rays[i], hits[i], exact).verdict;
    EXPECT_TRUE(verdict == Verdict::kRight || verdict == Verdict::kRounded)
        << judge_test::describeRay(rays[i]);
    right += verdict == Verdict::kRight;
    met += hits[i].triangle != kNoTriangle;
  }
  EXPECT_GE(right, 4990u);
  EXPECT_GE(met, 2000u);
}

TEST(Embree, MeetsNothingWhereItBegins) {
  SL_SKIP_WITHOUT_EMBREE();
  testing_support::SceneOfBoxes boxes;
  boxes.addTriangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  const uint32_t behind = boxes.addTriangle({-1, -1, 1}, {1, -1, 1}, {0, 1, 1});
  const Scene scene = boxes.finish();
  const auto embree = makeDevice("embree", scene, buildBvh(scene.positions, scene.triangles));
  const Ray ray{vec4(0), vec4(0, 0, 1, 0)};
  Hit hit{};
  embree->traceRays({&ray, 1}, {&hit, 1});
  EXPECT_EQ(hit.triangle, behind);
  EXPECT_EQ(hit.t, 1.0f);
}

TEST(Embree, IsCrosscheckedAloneOrFirstAndBakesNothing) {
  SL_SKIP_WITHOUT_EMBREE();
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-4, -3, -5}, {4, 3, 5});
  boxes.addBox({0, -1, -1}, {1, 1, 1});
  const Scene scene = boxes.finish();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const ViewCell cell{"cell", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {0, 0, 0}};
  const auto embree = makeDevice("embree", scene, bvh), cpu = makeDevice("cpu", scene, bvh);
  EXPECT_FALSE(canBake(*embree));
  EXPECT_TRUE(canBake(*cpu));
  CrosscheckOptions options;
  options.rays = 300;
  options.kinds = {RayKind::kRandom, RayKind::kBorder};
  Device* const both[] = {embree.get(), cpu.get()};
  for (const size_t count : {size_t(1), size_t(2)}) {
    const CrosscheckReport report =
        crosscheck(scene, bvh, std::span(&cell, 1), std::span(both).first(count), options);
    EXPECT_GT(report.kinds[0].devices[0].hits, 250u);
    EXPECT_EQ(report.kinds[0].devices[0].verdicts(Verdict::kWrong), 0u);
    EXPECT_EQ(report.kinds[1].rays, 300u) << "the targets were found by a device that bakes";
  }
  try {
    bakeCell(*embree, scene, cell, 0, testing_support::quickParams());
    ADD_FAILURE() << "it baked";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "embree traces rays for crosscheck and trace only; take cpu, opencl or vulkan");
  }
}

}  // namespace
}  // namespace sightline
