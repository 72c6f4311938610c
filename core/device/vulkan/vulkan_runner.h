#pragma once
#include <array>
#include <cstdint>

#include "core/device/gpu/gpu_stage.h"
#include "core/shared/counters.h"
#include "core/vulkan/vulkan_commands.h"
#include "vk_shaders/launch.h"

namespace sightline {

/// Runs stages on a VulkanLaunch that the host changes between them, and reads what they count.
class VulkanRunner {
 public:
  explicit VulkanRunner(const VulkanContext& context);

  VulkanLaunch launch{};
  VulkanCommands commands;

  /// Puts a buffer's address into the launch.
  void bind(StageBuffer name, const VulkanBuffer& buffer) {
    launch.addresses[uint32_t(name)] = buffer.address();
  }
  /// Records the stage over `count` work items with the launch as it is now.
  void run(const VulkanStage& stage, uint32_t count);
  /// Records that the launch is what it is now, for commands that are no stage; returns its address.
  VkDeviceAddress recordLaunch();
  /// Runs everything recorded, reads the counters and sets them back to 0.
  std::array<uint32_t, kCounterWords> takeCounters();

 private:
  VulkanBuffer launches_;  ///< kLaunches, used in turn: one is filled while the last is read
  uint32_t turn_ = 0;
  VulkanBuffer counters_, readback_;
};

}  // namespace sightline
