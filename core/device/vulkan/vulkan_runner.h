#pragma once
#include <cstdint>

#include "core/vulkan/vulkan_commands.h"
#include "vk_shaders/launch.h"

namespace sightline {

/// What launches counted.
struct VulkanCounts {
  uint64_t rays = 0;
  uint32_t missing = 0;   ///< rays that hit something outside the set
  uint32_t listed = 0;    ///< what sum_blocks summed up last: bits for a list, border rays ...
  uint32_t fresh = 0;     ///< ... and the set's bits of new triangles
  bool overflow = false;  ///< the hash set was full
};

/// Runs stages on a VulkanLaunch that the host changes between them, and reads what they count.
class VulkanRunner {
 public:
  explicit VulkanRunner(const VulkanContext& context);

  VulkanLaunch launch{};
  VulkanCommands commands;

  /// Records the stage over `count` work items with the launch as it is now.
  void run(const VulkanStage& stage, uint32_t count);
  /// Records that the launch is what it is now, for commands that are no stage; returns its address.
  VkDeviceAddress recordLaunch();
  /// Runs everything recorded, and sets the counters back to 0.
  VulkanCounts takeCounts();

 private:
  VulkanBuffer launches_;  ///< kLaunches, used in turn: one is filled while the last is read
  uint32_t turn_ = 0;
  VulkanBuffer counters_, readback_;
};

}  // namespace sightline
