// The rays that the Vulkan shaders make, bit by bit those of the shared code in C++.
#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_runner.h"
#include "core/device/vulkan/vulkan_scene.h"
#include "core/generate/generate.h"
#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/scene/view_cell.h"
#include "core/shared/border.h"
#include "core/shared/random_ray.h"
#include "core/shared/reverse.h"
#include "core/trace/cpu_tracer.h"
#include "tests/backend/trace_cases.h"
#include "tests/support/bake_scene.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

testing::AssertionResult sameRay(const char*, const char*, const Ray& actual, const Ray& expected) {
  if (std::memcmp(&actual, &expected, sizeof(Ray)) == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "made   " << describeRay(actual) << "\nwanted "
                                     << describeRay(expected);
}

class VulkanRays : public testing::Test {
 protected:
  void SetUp() override {
    SL_SKIP_WITHOUT_VULKAN();
    context_ = std::make_unique<VulkanContext>("vulkan", tracingNeeds(false));
    runner_ = std::make_unique<VulkanRunner>(*context_);
    on_device_ = uploadVulkanScene(*context_, scene_, bvh_, 0);
    on_device_.describe(*runner_);
    params_.counts = uvec4(7, 5, 11, faces_.size());
    params_.shifts = uvec4(0x9e3779b9u, 12345678u, 99u, 1000007u);
    params_.distances = vec4(1e-4f, 1e-5f, 1e-3f, 1e-4f);
    params_.method.y = 1;
    params_.spacing.x = 0.01f;
    launch().params = params_;
    launch().shifts = params_.shifts;
    put(StageBuffer::faces, faces_);
  }

  StageLaunch& launch() { return runner_->launch.numbers; }

  /// Uploads and binds.
  template <typename T>
  void put(StageBuffer name, const std::vector<T>& values) {
    buffers_.push_back(context_->buffer(values.size() * sizeof(T), "test data"));
    VulkanUpload upload(*context_);
    upload.write(buffers_.back(), values.data(), values.size() * sizeof(T));
    upload.finish();
    runner_->bind(name, buffers_.back());
  }

  /// What `count` work items of a list shader write, `bytes` bytes each.
  void prepare(const char* shader, StageBuffer output, uint32_t count, uint64_t bytes) {
    buffers_.push_back(context_->buffer(count * bytes, shader));
    runner_->bind(output, buffers_.back());
    const VulkanStage stage = VulkanStage::list(*context_, shader);
    runner_->run(stage, count);
    runner_->takeCounters();
  }

  /// The rays of a stage as the shaders make them.
  std::vector<Ray> make(uint32_t stage, uint32_t count) {
    const uint64_t bytes = count * sizeof(Ray);
    const VulkanBuffer rays = context_->buffer(bytes, "rays");
    const VulkanBuffer staging = context_->buffer(bytes, "rays", VulkanMemory::kReadback);
    const VulkanStage stage_rays = VulkanStage::list(*context_, "stage_rays");
    launch().stage = stage;
    runner_->bind(StageBuffer::rays, rays);
    runner_->run(stage_rays, count);
    runner_->commands.copy(rays, staging, bytes);
    runner_->takeCounters();
    std::vector<Ray> result(count);
    std::memcpy(result.data(), staging.mapped(), bytes);
    return result;
  }

  /// Compares the border rays of entries, and the reverse rays of some of them.
  void compareBorderAndReverse();

  const Scene scene_ = generateScene("bistro", 20'000, 3);
  const ViewCell cell_ = generateCells("bistro", 20'000, 3).front();
  const Bvh bvh_ = buildBvh(scene_.positions, scene_.triangles);
  const std::vector<Face> faces_ = cellFaces(cell_);
  StageParams params_{};
  std::unique_ptr<VulkanContext> context_;
  std::unique_ptr<VulkanRunner> runner_;
  VulkanScene on_device_;
  std::vector<VulkanBuffer> buffers_;
};

TEST_F(VulkanRays, Random) {
  uint64_t rays = 0;
  for (uint32_t f = 0; f < faces_.size(); ++f) {
    const RandomSegment segment = makeRandomSegment(f, 5'000'000'000 + 7919 * f, 100'003, 1);
    launch().segment = segment;
    const auto slots = static_cast<uint32_t>(slotCount(segment));
    const std::vector<Ray> made = make(kStageRandom, slots);
    for (uint32_t slot = 0; slot < slots; ++slot) {
      const uint32_t offset = slotOffset(segment, slot);
      if (offset == kNoTriangle) continue;  // such a slot traces nothing
      ASSERT_PRED_FORMAT2(sameRay, made[slot], offsetRay(segment, faces_[f], params_.shifts, offset))
          << "face " << f << ", slot " << slot;
      ++rays;
    }
  }
  EXPECT_EQ(rays, faces_.size() * 100'003);
}

/// Border rays of what random rays hit, and of every kind of triangle from points beside, behind and on it.
TEST_F(VulkanRays, BorderAndReverse) {
  compareBorderAndReverse();
}

/// The same of the original method: all places of the polygons, and rays past occluders.
TEST_F(VulkanRays, BorderAndReverseOfGvs) {
  params_.method.x = kSampleGvs;
  launch().params = params_;
  compareBorderAndReverse();
}

void VulkanRays::compareBorderAndReverse() {
  const CpuTracer tracer(scene_, bvh_);
  std::vector<PvsEntry> entries;
  const RandomSegment segment = makeRandomSegment(0, 0, 3000, 1);
  for (uint32_t slot = 0; slot < slotCount(segment); ++slot) {
    const Ray ray = offsetRay(segment, faces_[0], params_.shifts, slotOffset(segment, slot));
    const Hit hit = tracer.trace(ray);
    const uint32_t triangle =
        hit.triangle != kNoTriangle ? hit.triangle : slot * 7919u % uint32_t(scene_.triangles.size());
    entries.push_back({uvec4(floatBitsToUint(ray.origin.x), floatBitsToUint(ray.origin.y),
                             floatBitsToUint(ray.origin.z), triangle),
                       uvec4(floatBitsToUint(ray.direction.x), floatBitsToUint(ray.direction.y),
                             floatBitsToUint(ray.direction.z), kStageRandom)});
  }
  const std::vector<uint64_t> starts = borderStarts(scene_, entries, params_);
  const auto total = static_cast<uint32_t>(starts.back());
  if (!isGvs(params_)) {
    ASSERT_LT(total, entries.size() * borderRayCount(params_.counts.x, params_));  // the spacing thins some
  }
  put(StageBuffer::entries, entries);
  put(StageBuffer::border_starts, std::vector<uint32_t>(starts.begin(), starts.end()));
  launch().border_count = uint32_t(entries.size());
  prepare("border_edges", StageBuffer::border_edges, uint32_t(entries.size()) * 3, sizeof(BorderEdge));
  const std::vector<Ray> made = make(kStageBorder, total);
  const BorderRays polygons(scene_, entries, starts, params_);
  std::vector<Ray> border(total);
  std::vector<uvec4> place(total);  // of a discontinuity, were there one
  for (uint32_t i = 0; i < total; ++i) {
    const uint32_t e = polygons.entryOf(i), k = polygons.rayOf(i, e);
    const uint32_t samples = borderSamplesOf(scene_, entries[e], params_);
    place[i] = uvec4(e, k, kNoTriangle, samples);
    border[i] = borderRayOf(scene_, entries[e], k, samples, params_);
    ASSERT_PRED_FORMAT2(sameRay, made[i], border[i]) << "border ray " << i;
  }

  // Reverse rays of every 29th border ray, as if it had met a discontinuity, with the occluder that it hit.
  std::vector<Discontinuity> waiting;
  for (uint32_t i = 0; i < total; i += 29) {
    place[i].z = tracer.trace(border[i]).triangle;
    waiting.push_back({place[i]});
  }
  put(StageBuffer::discontinuities, waiting);
  launch().items_before = 0xfffffff0ull;  // running numbers past 32 bits
  const uint32_t per_item = reverseRayCount(params_);
  const auto reverse_total = static_cast<uint32_t>(waiting.size() * per_item);
  prepare("reverse_items", StageBuffer::reverse_items, uint32_t(waiting.size()), sizeof(ReverseItem));
  const std::vector<Ray> reverse = make(kStageReverse, reverse_total);
  uint32_t excluded = 0;
  for (uint32_t i = 0; i < reverse_total; ++i) {
    const uint32_t w = i / per_item;
    const HostStage stage{&scene_, faces_, &params_, entries, waiting, launch().items_before};
    const Ray expected = reverseRayOf(stage, reverseItemAt(stage, w), i % per_item);
    ASSERT_PRED_FORMAT2(sameRay, reverse[i], expected) << "reverse ray " << i;
    excluded += !hasDirection(expected);
  }
  EXPECT_GT(excluded, 0u);
  EXPECT_LT(excluded, reverse_total / 20 * 19);
}

}  // namespace
}  // namespace sightline
