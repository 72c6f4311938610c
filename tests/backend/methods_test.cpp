// The methods that gvs++ is compared with, on every device.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
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

/// Every method finds the room and the pillar in it, and nothing that stands behind the walls.
TEST_P(Methods, EachFindsWhatCanBeSeenAndNothingElse) {
  SceneOfBoxes boxes;
  const uint32_t room = boxes.addBox({-5, 0, -5}, {5, 3, 5});
  boxes.addBox({2, 0.5f, 2}, {2.5f, 1, 2.5f});
  boxes.addBox({-50, -1, 6}, {50, 40, 7});
  boxes.addBox({5.001f, 0, -5}, {6, 3, 5});
  const Scene scene = boxes.finish();
  for (const Method method : {Method::kGvspp, Method::kGvs, Method::kRandom}) {
    const CellPvs pvs = bakeOn(GetParam(), scene, {"cell", {0, 1.5, 0}, {1, 1, 1}}, params(method));
    EXPECT_TRUE(std::ranges::includes(pvs.triangles, testing_support::idRange(room, 12)))
        << methodName(method);
    EXPECT_LT(pvs.triangles.back(), 24u) << methodName(method);
    EXPECT_GE(pvs.triangles.size(), 18u) << methodName(method);
  }
}

/// A wall of a hundred small squares, found from one to the next along their borders.
TEST_P(Methods, GvsFindsNeighbours) {
  SceneOfBoxes boxes;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) boxes.addRectangle({float(x) - 5, float(y) - 5, 0}, {1, 0, 0}, {0, 1, 0});
  }
  BakeParams p = params(Method::kGvs);
  p.n_rand = 64;
  const CellPvs pvs = bakeOn(GetParam(), boxes.finish(), {"cell", {0, 0, 5}, {1, 1, 0}, {0, 180, 0}}, p);
  EXPECT_GE(pvs.triangles.size(), 198u) << "nine rays may miss a neighbour in a corner";
  EXPECT_GT(pvs.stats.border.new_triangles, 100u);
}

/// Nine small triangles stand apart on the upper edge of a large one, at its eighths: no ray but the
/// subdivision's finds the seven between the corners.
TEST_P(Methods, GvsDividesEdgesWhereTheirEndsSeeDifferentTriangles) {
  SceneOfBoxes boxes;
  boxes.addTriangle({-8, 0, 0}, {8, 0, 0}, {0, -8, 0});
  for (int i = 0; i <= 8; ++i) {
    const float x = -8 + 2 * float(i);
    boxes.addTriangle({x - 0.01f, 0, 0}, {x + 0.01f, 0, 0}, {x, 0.01f, 0});
  }
  BakeParams p = params(Method::kGvs);
  p.n_rand = 64;
  const CellPvs pvs = bakeOn(GetParam(), boxes.finish(), {"cell", {0, 0, 10}, {1, 1, 0}, {0, 180, 0}}, p);
  EXPECT_EQ(pvs.triangles, testing_support::idRange(0, 10));
  ASSERT_EQ(pvs.witnesses.size(), 10u);
  for (uint32_t i = 1; i < 10; ++i) EXPECT_EQ(pvs.witnesses[i].stage, kStageBorder) << i;
}

/// A small triangle touches the tip of a large one; from nearly all of the cell an occluder hides both the
/// tip and it. The border sample at the tip meets the occluder, and a ray past the occluder finds it.
TEST_P(Methods, GvsLooksPastAnOccluder) {
  for (const double depth : {0.0, 0.5}) {
    SceneOfBoxes boxes;
    boxes.addTriangle({-4, -1, 0}, {-4, 1, 0}, {0, 0, 0});
    boxes.addTriangle({-1, -20, 5}, {1, -20, 5}, {0, 40, 5});
    const uint32_t hidden = boxes.addTriangle({0, -0.05f, 0}, {0, 0.05f, 0}, {0.1f, 0, 0});
    BakeParams p = params(Method::kGvs);
    p.n_rand = depth == 0 ? 200 : 2000;  // a box looks to all sides
    const ViewCell cell{"cell", {0, 0, 10 + depth / 2}, {2.8, 1, depth}, {0, depth == 0 ? 180.0 : 0.0, 0}};
    const CellPvs pvs = bakeOn(GetParam(), boxes.finish(), cell, p);
    ASSERT_EQ(pvs.triangles, testing_support::idRange(0, 3)) << "depth " << depth;
    const Witness& witness = pvs.witnesses[hidden];
    EXPECT_EQ(witness.stage, kStageReverse) << "depth " << depth;
    EXPECT_EQ(witness.origin.z, 10.0f) << "the face that looks at the target, depth " << depth;
    EXPECT_LE(std::abs(witness.origin.x), 1.4f);
    EXPECT_GT(std::abs(witness.origin.x), 1.3f) << "just past the occluder";
  }
}

/// Fewer rays an entry than gvs++, and fewer triangles.
TEST_P(Methods, GvsFindsMoreThanRandomRaysAndLessThanGvspp) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  BakeParams p = params(Method::kGvs);
  p.threshold = 1'000'000'000;  // one iteration
  const CellPvs gvs = bakeOn(GetParam(), scene, cell, p);
  p.method = Method::kRandom;
  const CellPvs random = bakeOn(GetParam(), scene, cell, p);
  p.method = Method::kGvspp;
  p.n_abs_edge = p.n_rs_edge = p.n_rs_area = 8;
  const CellPvs gvspp = bakeOn(GetParam(), scene, cell, p);
  EXPECT_EQ(gvs.stats.iterations, 1u);
  EXPECT_GT(gvs.triangles.size(), random.triangles.size() * 11 / 10);
  EXPECT_GT(gvspp.triangles.size(), gvs.triangles.size());
  EXPECT_GT(gvs.stats.reverse.new_triangles, 0u);
  // 9 to 72 border rays an explored triangle, at most two reverse rays for each.
  EXPECT_GE(gvs.stats.border.rays, (gvs.triangles.size() - gvs.stats.contained_triangles) * 9);
  EXPECT_LE(gvs.stats.border.rays, gvs.triangles.size() * 72);
  EXPECT_LE(gvs.stats.reverse.rays, gvs.stats.border.rays * 2);
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

/// In the thesis's order reverse rays follow every batch of border rays; by yield border rays come first.
TEST_P(Methods, TheOrderDecidesWhenReverseRaysCome) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  const auto borderBatchesInARow = [&](Order order) {
    BakeParams p = params(Method::kGvspp);
    p.order = order;
    p.batch_rays = 1u << 13;
    p.max_rays = 500'000;
    BakeTrace trace;
    bakeCell(*device, scene, cell, 0, p, {.trace = &trace});
    size_t most = 0, row = 0;
    for (size_t i = 1; i < trace.curve.size(); ++i) {
      const bool border = trace.curve[i].rays[kStageBorder] > trace.curve[i - 1].rays[kStageBorder];
      row = border ? row + 1 : 0;
      most = std::max(most, row);
    }
    return most;
  };
  EXPECT_EQ(borderBatchesInARow(Order::kQueue), 1u);
  EXPECT_GT(borderBatchesInARow(Order::kYield), 4u);
}

/// Discontinuities that found no room in the list get their reverse rays too: their border rays come again.
TEST_P(Methods, AFullListOfDiscontinuitiesLosesNone) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  BakeParams p = params(Method::kGvspp);
  p.batch_rays = 1u << 13;
  const CellPvs roomy = bakeCell(*device, scene, cell, 0, p);
  const CellPvs full = bakeCell(*device, scene, cell, 0, p, {.most_listed = 1000});
  EXPECT_GT(full.stats.border.rays, roomy.stats.border.rays * 5 / 4);
  EXPECT_GT(full.stats.reverse.rays, roomy.stats.reverse.rays * 19 / 20);
  EXPECT_NEAR(double(full.triangles.size()), double(roomy.triangles.size()),
              0.01 * double(roomy.triangles.size()));
  const auto reference = makeDevice("cpu", scene, bvh);
  if (std::string(GetParam()) != "vulkan") {
    EXPECT_EQ(full.triangles, bakeCell(*reference, scene, cell, 0, p, {.most_listed = 1000}).triangles);
  }
}

/// The naive implementation gives the set of gvs++ with the same witnesses, in the same order.
TEST_P(Methods, NaiveIsGvsppWithTheSetOnTheHost) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  const auto naive = makeNaiveDevice(makeDevice(GetParam(), scene, bvh), scene);
  BakeParams p = params(Method::kGvspp);
  for (const Order order : {Order::kQueue, Order::kYield}) {
    p.order = order;
    p.method = Method::kGvspp;
    BakeTrace trace, naive_trace;
    const CellPvs expected = bakeCell(*device, scene, cell, 0, p, {.trace = &trace});
    p.method = Method::kNaive;
    const CellPvs pvs = bakeCell(*naive, scene, cell, 0, p, {.trace = &naive_trace});
    ASSERT_EQ(pvs.triangles, expected.triangles);
    ASSERT_EQ(naive_trace.order, trace.order);
    for (size_t i = 0; i < pvs.witnesses.size(); ++i) {
      ASSERT_EQ(pvs.witnesses[i].origin, expected.witnesses[i].origin) << i;
      ASSERT_EQ(pvs.witnesses[i].direction, expected.witnesses[i].direction) << i;
      ASSERT_EQ(pvs.witnesses[i].stage, expected.witnesses[i].stage) << i;
    }
    EXPECT_EQ(pvs.stats.random.rays, expected.stats.random.rays);
    EXPECT_EQ(pvs.stats.border.rays, expected.stats.border.rays);
    EXPECT_EQ(pvs.stats.reverse.rays, expected.stats.reverse.rays);
    EXPECT_EQ(pvs.stats.missing_rays, expected.stats.missing_rays);
  }
}

/// The set would be right, but called naive where it is not: a comparison of methods would time gvs++ twice.
TEST_P(Methods, NaiveIsRefusedOnADeviceWithItsOwnSet) {
  SceneOfBoxes boxes;
  boxes.addBox({-5, 0, -5}, {5, 3, 5});
  try {
    bakeOn(GetParam(), boxes.finish(), {"cell", {0, 1.5, 0}, {1, 1, 1}}, params(Method::kNaive));
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("naive"), std::string::npos) << line;
    EXPECT_NE(line.find("makeNaiveDevice"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

/// A prefix of the order is the set at a point of the curve: a bake with fewer rays ends with it.
TEST_P(Methods, TheTraceTellsHowTheSetGrew) {
  const Scene scene = generateScene("city", 20'000, 7);
  const ViewCell cell = generateCells("city", 20'000, 7).front();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  for (const Method method : {Method::kGvspp, Method::kGvs, Method::kRandom}) {
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
    p.max_rays = middle.allRays();
    const CellPvs part = bakeCell(*device, scene, cell, 0, p);
    std::vector<uint32_t> prefix(trace.order.begin(), trace.order.begin() + middle.size);
    std::sort(prefix.begin(), prefix.end());
    ASSERT_EQ(part.stats.contained_triangles, 0u);
    EXPECT_EQ(part.triangles, prefix);
    std::sort(trace.order.begin(), trace.order.end());
    EXPECT_EQ(trace.order, pvs.triangles);
  }
}

/// What is known to be hidden does not enter the set, and changes nothing else of it.
TEST_P(Methods, WhatIsHiddenStaysOutOfTheSet) {
  const Scene scene = generateScene("city", 3000, 1);
  const ViewCell cell = generateCells("city", 3000, 1)[4];
  const Bvh bvh = buildSceneTree(scene, {});
  const auto device = makeDevice(GetParam(), scene, bvh, {});
  for (const Method method : {Method::kGvspp, Method::kGvs, Method::kRandom}) {
    const CellPvs all = bakeCell(*device, scene, cell, 0, params(method));
    std::vector<uint32_t> hidden;
    for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
      if (!std::binary_search(all.triangles.begin(), all.triangles.end(), id)) hidden.push_back(id);
    }
    ASSERT_GT(hidden.size(), 100u);
    BakeHooks hooks;
    hooks.hidden = hidden;
    const CellPvs within = bakeCell(*device, scene, cell, 0, params(method), hooks);
    EXPECT_EQ(within.triangles, all.triangles);
    EXPECT_EQ(within.stats.random.rays, all.stats.random.rays);
    EXPECT_EQ(within.stats.border.rays, all.stats.border.rays);
    EXPECT_EQ(within.stats.reverse.rays, all.stats.reverse.rays);
    ASSERT_EQ(within.witnesses.size(), all.witnesses.size());
    for (size_t i = 0; i < all.witnesses.size(); ++i) {
      EXPECT_EQ(within.witnesses[i].origin, all.witnesses[i].origin);
      EXPECT_EQ(within.witnesses[i].direction, all.witnesses[i].direction);
    }
    // One that is seen, as if by a leak.
    const uint32_t leak = all.triangles[all.triangles.size() / 2];
    hidden.insert(std::lower_bound(hidden.begin(), hidden.end(), leak), leak);
    hooks.hidden = hidden;
    const CellPvs without = bakeCell(*device, scene, cell, 0, params(method), hooks);
    EXPECT_FALSE(std::binary_search(without.triangles.begin(), without.triangles.end(), leak));
    EXPECT_TRUE(std::includes(all.triangles.begin(), all.triangles.end(), without.triangles.begin(),
                              without.triangles.end()));
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, Methods, testing::Values("cpu", "opencl", "vulkan"),
                         [](const auto& device) { return std::string(device.param); });

}  // namespace
}  // namespace sightline
