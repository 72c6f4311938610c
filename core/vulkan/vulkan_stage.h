#pragma once
#include <cstdint>
#include <string>

#include "core/vulkan/vulkan_context.h"

namespace sightline {

/// What all shaders get by push constants (vk_shaders/state.glsl).
struct VulkanPush {
  VkDeviceAddress launch;  ///< of the VulkanLaunch
  uint32_t first_item;
  uint32_t item_end;
};

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
  /// A compute shader ("count_bits") with groups of 64. It is compiled when it is first recorded, since who
  /// only traces rays needs none of them.
  static VulkanStage list(const VulkanContext& context, const std::string& name);

  /// Records the dispatch of the items 0 .. count - 1, in pieces that the device takes.
  /// launch: address of the VulkanLaunch.
  void record(VkCommandBuffer commands, VkDeviceAddress launch, uint32_t count) const;

 private:
  void createLayout(VkShaderStageFlags stages) {
    stages_ = stages;
    layout_ = pushLayout(*context_, stages);
  }
  void createPipeline(const std::string& name) const;
  void createRayPipeline(const std::string& name);

  const VulkanContext* context_ = nullptr;
  VkShaderStageFlags stages_ = 0;
  uint32_t group_size_ = 0;  ///< 0: ray tracing pipeline
  VulkanHandle<VkPipelineLayout> layout_;
  std::string list_name_;                      ///< a list's shader, to be compiled at the first record()
  mutable VulkanHandle<VkPipeline> pipeline_;  ///< a device's stages are recorded by one thread at a time
  VulkanBuffer table_;                         ///< shader binding table: ray generation, miss, hit
  VkDeviceAddress table_start_ = 0;
  uint64_t table_stride_ = 0;
};

}  // namespace sightline
