#include "core/device/vulkan/vulkan_runner.h"

#include <cstddef>
#include <numeric>

#include "core/shared/view_ray.h"

namespace sightline {

// GLSL's scalar layout pads nothing and aligns each member by its own components: so must C++.
static_assert(offsetof(VulkanLaunch, tlas) == 176 && alignof(VulkanLaunch) == 8);
static_assert(sizeof(VulkanLaunch) == 176 + 32 * sizeof(uint64) + 20 * sizeof(uint));
static_assert(sizeof(Face) == 96 && sizeof(Ray) == 32 && sizeof(Hit) == 8 && sizeof(PvsEntry) == 32);
static_assert(sizeof(RandomSegment) == 64 && sizeof(StageParams) == 96 && sizeof(ViewFrame) == 64);

namespace {

/// In the buffer of launches: one that the command before may read, and the next. The bytes between them.
constexpr uint32_t kLaunches = 2, kLaunchStride = 512;
static_assert(sizeof(VulkanLaunch) <= kLaunchStride);

}  // namespace

VulkanRunner::VulkanRunner(const VulkanContext& context)
    : commands(context, context.queue(), context.queueFamily()),
      launches_(context.buffer(kLaunches * kLaunchStride, "launches")),
      counters_(context.buffer(kCounterWords * 4, "counters")),
      readback_(context.buffer(kCounterWords * 4, "counters", VulkanMemory::kReadback)) {
  launch.counters = counters_.address();
  commands.fill(counters_, 0, kCounterWords * 4);
}

void VulkanRunner::run(const VulkanStage& stage, uint32_t count) {
  if (count == 0) return;
  commands.run(stage, recordLaunch(), count);
}

VkDeviceAddress VulkanRunner::recordLaunch() {
  turn_ = (turn_ + 1) % kLaunches;
  commands.updateBeside(launches_, &launch, sizeof launch, turn_ * kLaunchStride);
  return launches_.address() + turn_ * kLaunchStride;
}

VulkanCounts VulkanRunner::takeCounts() {
  commands.copy(counters_, readback_, kCounterWords * 4);
  commands.fill(counters_, 0, kCounterWords * 4);
  commands.finish();
  const auto* words = static_cast<const uint32_t*>(readback_.mapped());
  VulkanCounts counts;
  counts.rays = std::accumulate(words, words + kRayCounters, uint64_t(0));
  counts.missing = words[kMissingCounter];
  counts.overflow = words[kOverflowCounter] != 0;
  counts.listed = words[kListCounter];
  counts.fresh = words[kFreshCounter];
  return counts;
}

}  // namespace sightline
