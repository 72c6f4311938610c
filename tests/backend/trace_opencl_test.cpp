// OpenCL's hits, bit by bit those of the reference.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/device/opencl/opencl_scene.h"
#include "core/sampling/random_segment.h"
#include "core/shared/random_ray.h"
#include "core/trace/cpu_tracer.h"
#include "tests/backend/trace_cases.h"

namespace sightline {
namespace {

/// With packets of eight rays and with single rays, as CPUs and GPUs trace them. Skips where there is no
/// OpenCL device at all; build.sh installs PoCL, so that CI never skips.
class OpenClTrace : public testing::TestWithParam<uint32_t> {
 protected:
  void SetUp() override {
    if (listOpenClDevices().empty()) GTEST_SKIP() << "no OpenCL device";
    context_ = std::make_unique<OpenClContext>("opencl");
    buildKernels(*context_, GetParam());
  }

  std::vector<Hit> trace(const OpenClScene& scene, const std::vector<Ray>& rays, uint32_t local) {
    const ClKernel kernel = context_->kernel("traceRaysKernel");
    const ClBuffer ray_buffer = context_->buffer(rays.size() * sizeof(Ray), "rays");
    const ClBuffer hit_buffer = context_->buffer(rays.size() * sizeof(Hit), "hits");
    context_->write(ray_buffer, rays.data(), rays.size() * sizeof(Ray));
    const uint32_t per_item = GetParam(), count = uint32_t(rays.size());
    context_->launch(kernel, (count + per_item - 1) / per_item, local, scene.nodes, scene.triangles,
                     scene.reach, ray_buffer, hit_buffer, count);
    std::vector<Hit> hits(count);
    context_->read(hit_buffer, hits.data(), count * sizeof(Hit));
    return hits;
  }

  std::unique_ptr<OpenClContext> context_;
};

TEST_P(OpenClTrace, GivesTheHitsOfTheReferenceWhateverTheTree) {
  for (const TraceCase& c : traceCases()) {
    for (const BvhConfig& config : traceConfigs()) {
      const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles, config);
      const CpuTracer reference(c.scene, bvh);
      const OpenClScene scene = uploadScene(*context_, c.scene, bvh, GetParam());
      const std::vector<Hit> hits = trace(scene, c.rays, 8);
      for (size_t i = 0; i < hits.size(); ++i) {
        ASSERT_PRED_FORMAT2(sameHit, hits[i], reference.trace(c.rays[i]))
            << c.name << ", ray " << i << " " << describeRay(c.rays[i]) << ", leaf size "
            << config.max_leaf_size << ", spatial splits " << config.spatial_splits;
      }
    }
  }
}

TEST_P(OpenClTrace, IdsPast2To24StayWhole) {
  const TraceCase& c = traceCases().front();
  const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
  const CpuTracer reference(c.scene, bvh);
  const uint32_t offset = (1u << 24) + 1;
  const std::vector<Hit> hits = trace(uploadScene(*context_, c.scene, bvh, GetParam(), offset), c.rays, 8);
  for (size_t i = 0; i < hits.size(); ++i) {
    Hit expected = reference.trace(c.rays[i]);
    if (expected.triangle != kNoTriangle) expected.triangle += offset;
    ASSERT_PRED_FORMAT2(sameHit, hits[i], expected) << describeRay(c.rays[i]);
  }
}

TEST_P(OpenClTrace, SegmentsGiveEachRayItsHit) {
  const TraceCase& c = traceCases().front();
  const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
  const CpuTracer reference(c.scene, bvh);
  const OpenClScene scene = uploadScene(*context_, c.scene, bvh, GetParam());
  Face face{};
  face.corner = vec4(-0.5f, -0.5f, 0, 0);
  face.edge_u = face.axis_u = vec4(1, 0, 0, 0);
  face.edge_v = face.axis_v = vec4(0, 1, 0, 0);
  face.normal = vec4(0, 0, 1, 0);
  const uvec4 shifts(123456789u, 12345678u, 99u, 1000007u);
  const uint32_t count = 30011;
  const RandomSegment segment = makeRandomSegment(0, 5'000'000'000, count, 1);
  const uint64_t slots = slotCount(segment);
  const ClBuffer buffer = context_->buffer(slots * sizeof(Hit), "hits");
  const uint64_t per_item = GetParam();
  context_->launch(context_->kernel("traceSegmentKernel"), (slots + per_item - 1) / per_item, 8, scene.nodes,
                   scene.triangles, scene.reach, segment, face, shifts, buffer);
  std::vector<Hit> hits(slots);
  context_->read(buffer, hits.data(), slots * sizeof(Hit));
  uint32_t rays = 0;
  for (uint32_t slot = 0; slot < slots; ++slot) {
    const Ray ray = offsetRay(segment, face, shifts, slotOffset(segment, slot));
    ASSERT_PRED_FORMAT2(sameHit, hits[slot], reference.trace(ray)) << slot << " " << describeRay(ray);
    rays += slotOffset(segment, slot) != kNoTriangle;
  }
  EXPECT_EQ(rays, count);
}

INSTANTIATE_TEST_SUITE_P(RaysPerItem, OpenClTrace, testing::Values(8u, 1u),
                         [](const auto& rays) { return rays.param == 1 ? "single" : "packets"; });

}  // namespace
}  // namespace sightline
