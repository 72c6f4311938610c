#pragma once
#include <cstdint>
#include <string>

#include "core/vulkan/vulkan_context.h"
#include "vk_shaders/push.h"

namespace sightline {

/// The embedded shader of this name. Throws Error.
VulkanHandle<VkShaderModule> shaderModule(const VulkanContext& context, const std::string& name);
/// Its main function as a stage.
VkPipelineShaderStageCreateInfo stageInfo(VkShaderStageFlagBits stage, VkShaderModule module);
/// A layout of push constants for these stages and nothing else.
VulkanHandle<VkPipelineLayout> pushLayout(const VulkanContext& context, VkShaderStageFlags stages);
void destroyPipeline(const VulkanContext& context, VkPipeline pipeline);

/// A program that runs one work item an invocation: a tracing stage, or a compute shader over a list.
class VulkanStage {
 public:
  VulkanStage() = default;
  /// A tracing stage (trace_random, ...) of the context's kind. group_size: of ray queries.
  static VulkanStage tracing(const VulkanContext& context, const std::string& name, uint32_t group_size);
  /// A compute shader ("count_bits") with groups of SL_LIST_GROUP.
  static VulkanStage list(const VulkanContext& context, const std::string& name);

  /// Records the dispatch of the items 0 .. count - 1, in pieces that the device takes.
  /// launch: address of the VulkanLaunch.
  void record(VkCommandBuffer commands, VkDeviceAddress launch, uint32_t count) const;

 private:
  void createLayout(VkShaderStageFlags stages) {
    stages_ = stages;
    layout_ = pushLayout(*context_, stages);
  }
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
