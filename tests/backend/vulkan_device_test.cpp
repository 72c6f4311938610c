// The Vulkan device through the common interface.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "core/sampling/random_segment.h"
#include "core/shared/random_ray.h"
#include "core/trace/cpu_tracer.h"
#include "tests/backend/trace_cases.h"
#include "tests/support/bake_scene.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::bakeOn;

class VulkanDeviceTest : public testing::Test {
 protected:
  void SetUp() override { SL_SKIP_WITHOUT_VULKAN(); }

  /// Random rays of the cell's faces.
  static std::vector<Ray> randomRays(const ViewCell& cell, uint32_t per_face) {
    std::vector<Ray> rays;
    const std::vector<Face> faces = cellFaces(cell);
    for (uint32_t f = 0; f < faces.size(); ++f) {
      for (uint32_t i = 0; i < per_face; ++i) {
        rays.push_back(randomRay(0, f * per_face + i, faces[f], uvec4(1, 2, 3, 4)));
      }
    }
    return rays;
  }

  static std::vector<Hit> traceOn(const Scene& scene, const std::vector<Ray>& rays,
                                  const DeviceOptions& options = {}, const BvhConfig& tree = {}) {
    const Bvh bvh = buildBvh(scene.positions, scene.triangles, tree);
    std::vector<Hit> hits(rays.size());
    makeDevice("vulkan", scene, bvh, options)->traceRays(rays, hits);
    return hits;
  }

  static BakeParams params(Method method = Method::kGvspp) {
    BakeParams p;
    p.method = method;
    p.n_rand = 30'000;
    p.validation_rays = 10'000;
    p.batch_rays = 1u << 18;
    p.n_abs_edge = p.n_rs_edge = p.n_rs_area = 3;
    return p;
  }

  static void expectSame(const CellPvs& a, const CellPvs& b, const char* what) {
    ASSERT_EQ(a.triangles, b.triangles) << what;
    for (size_t i = 0; i < a.witnesses.size(); ++i) {
      ASSERT_EQ(a.witnesses[i].origin, b.witnesses[i].origin) << what << ", triangle " << i;
      ASSERT_EQ(a.witnesses[i].direction, b.witnesses[i].direction) << what << ", triangle " << i;
      ASSERT_EQ(a.witnesses[i].stage, b.witnesses[i].stage) << what << ", triangle " << i;
    }
    EXPECT_EQ(a.stats.random.rays, b.stats.random.rays) << what;
    EXPECT_EQ(a.stats.border.rays, b.stats.border.rays) << what;
    EXPECT_EQ(a.stats.reverse.rays, b.stats.reverse.rays) << what;
    EXPECT_EQ(a.stats.missing_rays, b.stats.missing_rays) << what;
  }

  void expectRepeatable(const BakeParams& p) const;
  void expectWhatTheDriverHits(const BakeParams& p) const;

  const Scene scene_ = generateScene("city", 20'000, 7);
  const ViewCell cell_ = generateCells("city", 20'000, 7).front();
};

/// Nearly all random rays hit the reference's triangle, at its distance up to a few steps of a float.
TEST_F(VulkanDeviceTest, RandomRaysHitWhatTheReferenceHits) {
  const std::vector<Ray> rays = randomRays(cell_, 5000);
  const std::vector<Hit> hits = traceOn(scene_, rays);
  const Bvh bvh = buildBvh(scene_.positions, scene_.triangles);
  const CpuTracer reference(scene_, bvh);
  size_t different = 0, hit = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit expected = reference.trace(rays[i]);
    hit += expected.triangle != kNoTriangle;
    if (hits[i].triangle != expected.triangle) {
      ++different;
    } else if (expected.triangle != kNoTriangle) {
      ASSERT_NEAR(hits[i].t, expected.t, 1e-4f * expected.t) << "ray " << i << " " << describeRay(rays[i]);
    }
  }
  EXPECT_GT(hit, rays.size() / 4);
  EXPECT_LE(different, rays.size() / 1000);
}

/// Both sides of a triangle are hit, wherever its corners turn.
TEST_F(VulkanDeviceTest, BothSidesAreHit) {
  Scene scene;
  scene.positions = {{-1, -1, 5}, {2, -1, 5}, {-1, 2, 5}};
  scene.triangles = {{0, 1, 2}};
  for (int turn = 0; turn < 2; ++turn) {
    const std::vector<Ray> rays = {{vec4(0, 0, 0, 0), vec4(0, 0, 2, 0)},
                                   {vec4(0, 0, 10, 0), vec4(0, 0, -2, 0)},
                                   {vec4(0, 0, 0, 0), vec4(0, 0, -2, 0)},
                                   {vec4(0), vec4(0)}};
    const std::vector<Hit> hits = traceOn(scene, rays);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(hits[i].triangle, 0u);
      EXPECT_EQ(hits[i].t, 2.5f);
    }
    EXPECT_EQ(hits[2].triangle, kNoTriangle) << "behind the origin";
    EXPECT_EQ(hits[3].triangle, kNoTriangle) << "a direction of zero";
    std::swap(scene.triangles[0].x, scene.triangles[0].y);
  }
}

/// Ids come back right through leaf order, parts and spatial splits.
TEST_F(VulkanDeviceTest, PartsAndTreesDoNotMatter) {
  const std::vector<Ray> rays = randomRays(cell_, 2000);
  const std::vector<Hit> expected = traceOn(scene_, rays);
  BvhConfig split;
  split.spatial_splits = true;
  for (const uint32_t part : {3000u, 64u}) {
    DeviceOptions options;
    options.part_triangles = part;
    for (const BvhConfig& tree : {BvhConfig{}, split}) {
      const std::vector<Hit> hits = traceOn(scene_, rays, options, tree);
      size_t different = 0;
      for (size_t i = 0; i < rays.size(); ++i) different += hits[i].triangle != expected[i].triangle;
      EXPECT_LE(different, rays.size() / 1000) << "parts of " << part << ", splits " << tree.spatial_splits;
    }
  }
}

/// The set stays bit for bit the same on repeated runs, with the hash set, and with ray queries, which
/// lavapipe answers by the same code.
TEST_F(VulkanDeviceTest, BakesAreRepeatable) {
  expectRepeatable(params());
}
TEST_F(VulkanDeviceTest, BakesByGvsAreRepeatable) {
  expectRepeatable(params(Method::kGvs));
}

void VulkanDeviceTest::expectRepeatable(const BakeParams& p) const {
  const Bvh bvh = buildBvh(scene_.positions, scene_.triangles);
  const auto device = makeDevice("vulkan", scene_, bvh);
  const CellPvs first = bakeCell(*device, scene_, cell_, 0, p);
  EXPECT_GT(first.triangles.size(), 500u);
  EXPECT_GT(first.stats.border.new_triangles, 0u);
  EXPECT_GT(first.stats.reverse.new_triangles, 0u);
  expectSame(bakeCell(*device, scene_, cell_, 0, p), first, "again");
  DeviceOptions hash;
  hash.set = SetKind::kHash;
  expectSame(bakeOn("vulkan", scene_, cell_, p, hash), first, "hash set");
  const auto devices = listVulkanDevices();
  if (devices.front().name.find("llvmpipe") == std::string::npos) return;
  DeviceOptions queries;
  queries.ray_queries = true;
  for (const uint32_t size : {0u, 5u}) {
    queries.work_group_size = size;
    expectSame(bakeOn("vulkan", scene_, cell_, p, queries), first, "ray queries");
  }
}

/// The set, to the last witness, is the one of the driver's own hits of rays that the host makes; and nearly
/// all witnesses hit what the reference hits.
TEST_F(VulkanDeviceTest, BakesWhatTheDriverHits) {
  expectWhatTheDriverHits(params());
}
TEST_F(VulkanDeviceTest, BakesByGvsWhatTheDriverHits) {
  expectWhatTheDriverHits(params(Method::kGvs));
}

void VulkanDeviceTest::expectWhatTheDriverHits(const BakeParams& p) const {
  const Bvh bvh = buildBvh(scene_.positions, scene_.triangles);
  const CellPvs pvs = bakeCell(*makeDevice("vulkan", scene_, bvh), scene_, cell_, 0, p);
  const auto on_host = makeNaiveDevice(makeDevice("vulkan", scene_, bvh), scene_);
  expectSame(pvs, bakeCell(*on_host, scene_, cell_, 0, p), "the driver's hits");
  const CpuTracer reference(scene_, bvh);
  size_t other_hits = 0;
  for (size_t i = 0; i < pvs.triangles.size(); ++i) {
    const Witness& witness = pvs.witnesses[i];
    if (witness.stage == kStageContained) continue;
    const Ray ray{vec4(witness.origin, 0), vec4(witness.direction, 0)};
    other_hits += reference.trace(ray).triangle != pvs.triangles[i];
  }
  EXPECT_LE(other_hits, pvs.triangles.size() / 100);
}

TEST_F(VulkanDeviceTest, SaysWhatTheDriversTreeTakes) {
  const Bvh bvh = buildBvh(scene_.positions, scene_.triangles);
  EXPECT_EQ(makeDevice("vulkan", scene_, bvh)->info().driver_tree_parts, 1u);
  DeviceOptions options;
  options.part_triangles = 6000;
  const DeviceInfo info = makeDevice("vulkan", scene_, bvh, options)->info();
  EXPECT_GE(info.driver_tree_parts, 4u);
  EXPECT_GT(info.driver_tree_bytes, scene_.triangles.size() * 16);
  EXPECT_LT(info.driver_tree_bytes, scene_.triangles.size() * 1000);
  EXPECT_GT(info.driver_tree_build_seconds, 0);
}

TEST_F(VulkanDeviceTest, NamesThatSelectNothingAreOneLine) {
  const Bvh bvh = buildBvh(scene_.positions, scene_.triangles);
  for (const char* name : {"vulkan:99", "vulkan:no such device", "vulkan:"}) {
    try {
      makeDevice(name, scene_, bvh);
      FAIL() << name;
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_NE(line.find(name), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }
}

}  // namespace
}  // namespace sightline
