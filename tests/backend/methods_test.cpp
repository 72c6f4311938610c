// The methods that gvs++ is compared with, on every device.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/gvs/thesis_params.h"
#include "core/scene/generate.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::bakeOn;
using testing_support::quickParams;
using testing_support::SceneOfBoxes;

class Methods : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (std::string(GetParam()) == "vulkan") {
      SL_SKIP_WITHOUT_VULKAN();
    }
  }
  static BakeParams params(Method method) {
    BakeParams p = quickParams();
    p.method = method;
    p.n_rand = 50'000;
    p.validation_rays = 10'000;
    p.batch_rays = 1u << 18;
    p.n_abs_edge = p.n_rs_edge = p.n_rs_area = 3;
    return p;
  }
};

/// Random rays find the room and nothing outside it, and no other rays are traced.
TEST_P(Methods, RandomTracesRandomRaysAlone) {
  SceneOfBoxes boxes;
  const uint32_t room = boxes.addBox({-5, 0, -5}, {5, 3, 5});
  boxes.addBox({-50, -1, 6}, {50, 40, 7});
  const CellPvs pvs =
      bakeOn(GetParam(), boxes.finish(), {"cell", {0, 1.5, 0}, {1, 1, 1}}, params(Method::kRandom));
  EXPECT_EQ(pvs.triangles, testing_support::idRange(room, 12));
  EXPECT_EQ(pvs.stats.iterations, 2u);
  EXPECT_EQ(pvs.stats.random.rays, 100'000u);
  EXPECT_EQ(pvs.stats.border.rays + pvs.stats.reverse.rays, 0u);
}

/// The first iteration's random rays are those of gvs++, which finds more.
TEST_P(Methods, RandomFindsWhatTheRandomRaysOfGvsppFind) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  BakeParams one = params(Method::kRandom);
  one.max_rays = one.n_rand;
  const CellPvs random = bakeOn(GetParam(), scene, cell, one);
  one.method = Method::kGvspp;
  one.max_rays = 0;
  const CellPvs gvspp = bakeOn(GetParam(), scene, cell, one);
  EXPECT_EQ(random.stats.random.rays, one.n_rand);
  EXPECT_GT(random.triangles.size(), 100u);
  EXPECT_GT(gvspp.triangles.size(), random.triangles.size());
  EXPECT_TRUE(std::ranges::includes(gvspp.triangles, random.triangles));
}

/// A prefix of the order is the set at a point of the curve: a bake with fewer rays ends with it.
TEST_P(Methods, TheTraceTellsHowTheSetGrew) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  for (const Method method : {Method::kGvspp, Method::kRandom}) {
    BakeParams p = params(method);
    p.threshold = 500;
    BakeTrace trace;
    trace.order = {7};
    const CellPvs pvs = bakeCell(*device, scene, cell, 0, p, {.trace = &trace});
    ASSERT_GT(trace.curve.size(), 1u);
    const CurvePoint last = trace.curve.back();
    EXPECT_EQ(last.rays[kStageRandom], pvs.stats.random.rays);
    EXPECT_EQ(last.rays[kStageBorder], pvs.stats.border.rays);
    EXPECT_EQ(last.rays[kStageReverse], pvs.stats.reverse.rays);
    EXPECT_EQ(last.new_triangles[kStageReverse], pvs.stats.reverse.new_triangles);
    EXPECT_EQ(last.iteration, pvs.stats.iterations);
    EXPECT_EQ(last.size + pvs.stats.contained_triangles, trace.order.size());
    for (size_t i = 1; i < trace.curve.size(); ++i) {
      const CurvePoint &a = trace.curve[i - 1], &b = trace.curve[i];
      EXPECT_LE(a.seconds, b.seconds);
      EXPECT_LE(a.size, b.size);
      EXPECT_EQ(b.size, b.new_triangles[0] + b.new_triangles[1] + b.new_triangles[2]);
    }

    // The same bake, stopped in the middle of the curve.
    const CurvePoint middle = trace.curve[trace.curve.size() / 2];
    p.max_rays = middle.rays[0] + middle.rays[1] + middle.rays[2];
    const CellPvs part = bakeCell(*device, scene, cell, 0, p);
    std::vector<uint32_t> prefix(trace.order.begin(), trace.order.begin() + middle.size);
    std::sort(prefix.begin(), prefix.end());
    if (part.stats.contained_triangles == 0) {
      EXPECT_EQ(part.triangles, prefix);
    }
    std::sort(trace.order.begin(), trace.order.end());
    EXPECT_EQ(trace.order, pvs.triangles);
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, Methods, testing::Values("cpu", "opencl", "vulkan"),
                         [](const auto& device) { return std::string(device.param); });

}  // namespace
}  // namespace sightline
