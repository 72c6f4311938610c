// Embree as a peer: it answers rays, before the same judge, and bakes nothing.
#include <gtest/gtest.h>

#include <set>

#include "core/base/error.h"
#include "core/crosscheck/crosscheck.h"
#include "core/device/embree/embree_device.h"
#include "core/device/registry/make_device.h"
#include "core/sampling/views.h"
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
  const auto embree = makeTracer("embree", scene, bvh);
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
  const auto embree = makeTracer("embree", scene, buildBvh(scene.positions, scene.triangles));
  const Ray ray{vec4(0), vec4(0, 0, 1, 0)};
  Hit hit{};
  embree->traceRays({&ray, 1}, {&hit, 1});
  EXPECT_EQ(hit.triangle, behind);
  EXPECT_EQ(hit.t, 1.0f);
}

TEST(Embree, SeesInViewsWhatItsRaysHit) {
  SL_SKIP_WITHOUT_EMBREE();
  judge_test::Random random(5);
  const Scene scene = judge_test::soup(random, 3000, 0.3f, 1);
  const auto embree = makeTracer("embree", scene, buildBvh(scene.positions, scene.triangles));
  const std::vector<ViewFrame> views =
      measureViews({"cell", {0, 0, 0}, {0.1, 0.1, 0.1}, {0, 0, 0}}, 0, 3, 1, 60);
  constexpr uint32_t kSide = 33;
  std::vector<uint32_t> seen(views.size() * kSide * kSide);
  embree->traceViews(views, kSide, seen);
  std::vector<Ray> rays;
  for (const ViewFrame& view : views) {
    for (uint32_t y = 0; y < kSide; ++y) {
      for (uint32_t x = 0; x < kSide; ++x) rays.push_back(viewRay(view, x, y, kSide));
    }
  }
  std::vector<Hit> hits(rays.size());
  embree->traceRays(rays, hits);
  std::set<uint32_t> distinct;
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(seen[i], hits[i].triangle) << i;
    distinct.insert(seen[i]);
  }
  EXPECT_GT(distinct.size(), 30u);
}

TEST(Embree, IsCrosscheckedAloneOrFirstAndBakesNothing) {
  SL_SKIP_WITHOUT_EMBREE();
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-4, -3, -5}, {4, 3, 5});
  boxes.addBox({0, -1, -1}, {1, 1, 1});
  const Scene scene = boxes.finish();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const ViewCell cell{"cell", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {0, 0, 0}};
  const auto embree = makeTracer("embree", scene, bvh);
  const auto cpu = makeDevice("cpu", scene, bvh);
  CrosscheckOptions options;
  options.rays = 300;
  options.kinds = {RayKind::kRandom, RayKind::kBorder};
  Tracer* const both[] = {embree.get(), cpu.get()};
  for (const size_t count : {size_t(1), size_t(2)}) {
    const CrosscheckReport report =
        crosscheck(scene, bvh, std::span(&cell, 1), std::span(both).first(count), *cpu, options);
    EXPECT_GT(report.kinds[0].devices[0].hits, 250u);
    EXPECT_EQ(report.kinds[0].devices[0].verdicts(Verdict::kWrong), 0u);
    EXPECT_EQ(report.kinds[1].rays, 300u) << "the targets were found by a device that bakes";
  }
  try {
    makeDevice("embree", scene, bvh);
    ADD_FAILURE() << "a device that bakes";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "embree traces rays for crosscheck and trace only; take cpu, opencl or vulkan");
  }
}

}  // namespace
}  // namespace sightline
