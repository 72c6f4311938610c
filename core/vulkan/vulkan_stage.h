#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/shared/vulkan_push.h"
#include "core/vulkan/vulkan_context.h"

namespace sightline {

/// The shader of this name of the context's program. Throws Error.
VulkanHandle<VkShaderModule> shaderModule(const VulkanContext& context, const std::string& name);
/// Its main function as a stage.
VkPipelineShaderStageCreateInfo stageInfo(VkShaderStageFlagBits stage, VkShaderModule module);
/// A layout of so many bytes of push constants for these stages and nothing else.
VulkanHandle<VkPipelineLayout> pushLayout(const VulkanContext& context, VkShaderStageFlags stages,
                                          uint32_t bytes = sizeof(VulkanPush));
void destroyPipeline(const VulkanContext& context, VkPipeline pipeline);
/// A compute shader of this name as a pipeline. constants: its specialisation, or nullptr. Throws Error.
VulkanHandle<VkPipeline> computePipeline(const VulkanContext& context, const std::string& name,
                                         VkPipelineLayout layout,
                                         const VkSpecializationInfo* constants = nullptr);

/// The shaders of a ray tracing pipeline.
struct VulkanRayShaders {
  /// What becomes of triangles: those that are not opaque go through any_hit first, if there is one.
  struct HitGroup {
    std::string closest_hit, any_hit;  ///< empty: none
  };
  std::string generation, miss;
  std::vector<HitGroup> hits;  ///< by the record offset of traceRayEXT
};

/// A program that runs one work item an invocation: a tracing stage, or a compute shader over a list.
class VulkanStage {
 public:
  VulkanStage() = default;
  /// A compute shader ("count_bits.comp"). group_size: work items, its constant 0.
  static VulkanStage compute(const VulkanContext& context, const std::string& name, uint32_t group_size);
  /// The same of shader "NAME.comp" with groups of SL_LIST_GROUP, compiled when it is first recorded, since
  /// who only traces rays needs none of them.
  static VulkanStage list(const VulkanContext& context, const std::string& name);
  /// A ray tracing pipeline. Threads may make several at once (a driver takes two seconds for one).
  static VulkanStage rays(const VulkanContext& context, const VulkanRayShaders& shaders);

  /// Compiles what is not yet.
  void compile() const {
    if (pipeline_.get() == VK_NULL_HANDLE) createPipeline(list_name_);
  }

  /// Records the dispatch of the items 0 .. count - 1, in pieces that the device takes.
  /// launch: of VulkanPush.
  void record(VkCommandBuffer commands, VkDeviceAddress launch, uint32_t count) const;

 private:
  void createLayout(VkShaderStageFlags stages) {
    stages_ = stages;
    layout_ = pushLayout(*context_, stages);
  }
  void createPipeline(const std::string& name) const;
  void createRayPipeline(const VulkanRayShaders& shaders);
  void readTable(uint32_t groups);
  void uploadTable() const;

  const VulkanContext* context_ = nullptr;
  VkShaderStageFlags stages_ = 0;
  uint32_t group_size_ = 0;  ///< 0: ray tracing pipeline
  VulkanHandle<VkPipelineLayout> layout_;
  std::string list_name_;                      ///< a list's shader, to be compiled at the first record()
  mutable VulkanHandle<VkPipeline> pipeline_;  ///< a device's stages are recorded by one thread at a time
  uint64_t table_stride_ = 0;
  std::vector<char> table_records_;  ///< shader binding table: ray generation, miss, hits
  mutable VulkanBuffer table_;       ///< of them, from the first record() on
  mutable VkDeviceAddress table_start_ = 0;
};

}  // namespace sightline
