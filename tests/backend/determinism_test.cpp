// The same PVS with the same witnesses, bit for bit, however it is computed.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "tests/support/bake_scene.h"

namespace sightline {
namespace {

using testing_support::bakeOn;

class Determinism : public testing::TestWithParam<Method> {
 protected:
  static BakeParams params() {
    BakeParams p;
    p.method = GetParam();
    p.n_rand = 150'000;
    p.validation_rays = 50'000;
    p.batch_rays = 1u << 18;
    p.n_abs_edge = p.n_rs_edge = p.n_rs_area = 6;
    return p;
  }

  void expectSame(const CellPvs& other, const char* what) const {
    ASSERT_EQ(other.triangles, reference_.triangles) << what;
    ASSERT_EQ(other.witnesses.size(), reference_.witnesses.size()) << what;
    for (size_t i = 0; i < other.witnesses.size(); ++i) {
      ASSERT_EQ(other.witnesses[i].origin, reference_.witnesses[i].origin) << what << ", triangle " << i;
      ASSERT_EQ(other.witnesses[i].direction, reference_.witnesses[i].direction)
          << what << ", triangle " << i;
      ASSERT_EQ(other.witnesses[i].stage, reference_.witnesses[i].stage) << what << ", triangle " << i;
    }
    const auto expectStage = [&](const StageStats& a, const StageStats& b) {
      EXPECT_EQ(a.rays, b.rays) << what;
      EXPECT_EQ(a.new_triangles, b.new_triangles) << what;
    };
    expectStage(other.stats.random, reference_.stats.random);
    expectStage(other.stats.border, reference_.stats.border);
    expectStage(other.stats.reverse, reference_.stats.reverse);
    EXPECT_EQ(other.stats.missing_rays, reference_.stats.missing_rays) << what;
    EXPECT_EQ(other.stats.iterations, reference_.stats.iterations) << what;
  }

  const Scene scene_ = generateScene("city", 30'000, 7);
  const ViewCell cell_ = generateCells("city", 30'000, 7).front();
  const CellPvs reference_ = bakeOn("cpu", scene_, cell_, params());
};

TEST_P(Determinism, ReferenceIsWorthComparing) {
  EXPECT_GT(reference_.triangles.size(), 500u);
  EXPECT_GT(reference_.stats.border.new_triangles, 0u);
  EXPECT_GT(reference_.stats.reverse.new_triangles, 0u);
}

TEST_P(Determinism, AnyThreadCount) {
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 7);  // than cores
  for (const int threads : {1, 2, 7}) {
    DeviceOptions options;
    options.threads = threads;
    expectSame(bakeOn("cpu", scene_, cell_, params(), options), "threads");
  }
}

TEST_P(Determinism, RepeatedRunsOnOneDevice) {
  const Bvh bvh = buildBvh(scene_.positions, scene_.triangles);
  for (const char* name : {"cpu", "opencl"}) {
    const auto device = makeDevice(name, scene_, bvh);
    for (int run = 0; run < 2; ++run) expectSame(bakeCell(*device, scene_, cell_, 0, params()), name);
  }
}

TEST_P(Determinism, AnyWorkGroupSize) {
  for (const uint32_t size : {1u, 5u, 64u}) {
    DeviceOptions options;
    options.work_group_size = size;
    expectSame(bakeOn("opencl", scene_, cell_, params(), options), "work-group size");
  }
}

TEST_P(Determinism, PacketsAndSingleRays) {
  for (const uint32_t rays : {8u, 1u}) {
    DeviceOptions options;
    options.rays_per_item = rays;
    expectSame(bakeOn("opencl", scene_, cell_, params(), options), "rays an item");
  }
}

TEST_P(Determinism, HashSetAndArray) {
  for (const char* name : {"cpu", "opencl"}) {
    DeviceOptions options;
    options.set = SetKind::kHash;
    expectSame(bakeOn(name, scene_, cell_, params(), options), name);
  }
}

TEST_P(Determinism, AnyTree) {
  BvhConfig tree;
  tree.max_leaf_size = 8;
  expectSame(bakeOn("cpu", scene_, cell_, params(), {}, tree), "leaves of 8");
  tree.spatial_splits = true;
  expectSame(bakeOn("cpu", scene_, cell_, params(), {}, tree), "spatial splits");
  expectSame(bakeOn("opencl", scene_, cell_, params(), {}, tree), "spatial splits on OpenCL");
}

TEST_P(Determinism, ScaleByAPowerOfTwo) {
  Scene scaled = scene_;
  for (glm::vec3& p : scaled.positions) p *= 1024.0f;
  ViewCell cell = cell_;
  cell.center *= 1024.0;
  cell.size *= 1024.0;
  for (const char* name : {"cpu", "opencl"}) {
    EXPECT_EQ(bakeOn(name, scaled, cell, params()).triangles, reference_.triangles) << name;
  }
}

TEST_P(Determinism, AnotherSeedFindsOtherWitnesses) {
  BakeParams other = params();
  other.seed = 2;
  const CellPvs pvs = bakeOn("cpu", scene_, cell_, other);
  ASSERT_FALSE(pvs.witnesses.empty());
  EXPECT_NE(pvs.witnesses.front().direction, reference_.witnesses.front().direction);
}

INSTANTIATE_TEST_SUITE_P(Methods, Determinism, testing::Values(Method::kGvspp, Method::kGvs),
                         [](const auto& method) { return method.param == Method::kGvs ? "gvs" : "gvspp"; });

}  // namespace
}  // namespace sightline
