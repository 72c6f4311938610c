#pragma once
#include <cstdint>
#include <string>

#include "core/device/vulkan_context.h"

namespace sightline {

/// A program that runs one work item an invocation: a tracing stage, or a compute shader over a list.
class VulkanStage {
 public:
  VulkanStage() = default;
  /// A tracing stage (trace_random, ...) of the context's kind. group_size: of ray queries.
  static VulkanStage tracing(const VulkanContext& context, const std::string& name, uint32_t group_size);
  /// A compute shader ("count_bits") with groups of 64.
  static VulkanStage list(const VulkanContext& context, const std::string& name);

  /// Records the dispatch of the items 0 .. count - 1, in pieces that the device takes.
  /// launch: address of the VulkanLaunch.
  void record(VkCommandBuffer commands, VkDeviceAddress launch, uint32_t count) const;

 private:
  void createLayout(VkShaderStageFlags stages);
  void createPipeline(const std::string& name, uint32_t group_size);
  void createRayPipeline(const std::string& name);

  const VulkanContext* context_ = nullptr;
  VkShaderStageFlags stages_ = 0;
  uint32_t group_size_ = 0;  ///< 0: ray tracing pipeline
  VulkanHandle<VkPipelineLayout> layout_;
  VulkanHandle<VkPipeline> pipeline_;
  VulkanBuffer table_;  ///< shader binding table: ray generation, miss, hit
  VkDeviceAddress table_start_ = 0;
  uint64_t table_stride_ = 0;
};

}  // namespace sightline
