#pragma once
#include <array>
#include <map>
#include <optional>

#include "core/draw/vulkan/draw_passes.h"
#include "core/vulkan/vulkan_stage.h"
#include "vk_shaders/draw_launch.h"

namespace sightline {

/// What a pipeline draws.
enum class DrawKind {
  opaque,     ///< by index
  masked,     ///< vertex by vertex, without holes
  glass,      ///< likewise, blended; tests depth, writes none
  meshlets,   ///< opaque, by mesh shaders
  query_box,  ///< boxes for queries: they test whether they are at least as near, and write nothing
  unit_box,   ///< boxes that leave flags
};

/// The programs of drawing, each made when it is first used. All have push constants of type DrawPush.
class DrawPrograms {
 public:
  DrawPrograms(const VulkanContext& context, const DrawPasses& passes);

  /// Binds a pipeline for draws within a pass, and pushes.
  void bind(VkCommandBuffer commands, DrawKind kind, const DrawPush& push);
  /// Records a dispatch of a compute shader ("pyramid.comp").
  void run(VkCommandBuffer commands, const char* name, const DrawPush& push, uint32_t groups_x,
           uint32_t groups_y = 1);

 private:
  VkPipeline graphics(DrawKind kind);
  VkPipeline compute(const char* name);

  const VulkanContext& context_;
  const DrawPasses& passes_;
  VkShaderStageFlags stages_;
  VulkanHandle<VkPipelineLayout> layout_;
  std::map<DrawKind, VulkanHandle<VkPipeline>> graphics_;
  std::map<std::string, VulkanHandle<VkPipeline>> compute_;
};

}  // namespace sightline
