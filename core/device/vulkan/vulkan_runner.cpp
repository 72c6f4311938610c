#include "core/device/vulkan/vulkan_runner.h"

#include <cstddef>
#include <cstring>

namespace sightline {

// GLSL's scalar layout pads nothing and aligns each member by its own components: so must C++.
static_assert(offsetof(VulkanLaunch, addresses) == sizeof(StageLaunch) && alignof(VulkanLaunch) == 8);
static_assert(sizeof(VulkanLaunch) ==
              sizeof(StageLaunch) + (kStageBuffers + 13) * sizeof(uint64) + 6 * sizeof(uint));
// OpenCL C rounds structs with vectors of four up to 16 bytes.
static_assert(sizeof(StageLaunch) % 16 == 0);
static_assert(sizeof(Face) == 96 && sizeof(Ray) == 32 && sizeof(Hit) == 8 && sizeof(PvsEntry) == 32);
static_assert(sizeof(RandomSegment) == 64 && sizeof(StageParams) == 96 && sizeof(ViewFrame) == 64);

namespace {

/// In the buffer of launches: one that the command before may read, and the next. The bytes between them.
constexpr uint32_t kLaunches = 2, kLaunchStride = 1024;
static_assert(sizeof(VulkanLaunch) <= kLaunchStride);

}  // namespace

VulkanRunner::VulkanRunner(const VulkanContext& context)
    : commands(context, context.queue(), context.queueFamily()),
      launches_(context.buffer(kLaunches * kLaunchStride, "launches")),
      counters_(context.buffer(kCounterWords * 4, "counters")),
      readback_(context.buffer(kCounterWords * 4, "counters", VulkanMemory::kReadback)) {
  bind(StageBuffer::counters, counters_);
  commands.fill(counters_, 0, kCounterWords * 4);
}

void VulkanRunner::run(const VulkanStage& stage, uint32_t count) {
  if (count == 0) return;
  launch.numbers.item_count = count;
  commands.run(stage, recordLaunch(), count);
}

VkDeviceAddress VulkanRunner::recordLaunch() {
  turn_ = (turn_ + 1) % kLaunches;
  commands.updateBeside(launches_, &launch, sizeof launch, turn_ * kLaunchStride);
  return launches_.address() + turn_ * kLaunchStride;
}

std::array<uint32_t, kCounterWords> VulkanRunner::takeCounters() {
  commands.copy(counters_, readback_, kCounterWords * 4);
  commands.fill(counters_, 0, kCounterWords * 4);
  commands.finish();
  std::array<uint32_t, kCounterWords> counters;
  std::memcpy(counters.data(), readback_.mapped(), sizeof counters);
  return counters;
}

}  // namespace sightline
