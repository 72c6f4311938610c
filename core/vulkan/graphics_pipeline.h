#pragma once
#include <span>
#include <string>

#include "core/vulkan/vulkan_context.h"

namespace sightline {

/// What our graphics pipelines differ in. All draw triangles filled, from both sides, a sample a pixel, over
/// the viewport and scissor that commands set; their shaders read vertices themselves; nearer is greater in
/// depth.
struct GraphicsPipeline {
  std::string vertex;    ///< shader; of `mesh` the mesh shader
  std::string fragment;  ///< empty: none
  bool mesh = false;
  bool strips = false;  ///< vertices are those of a strip, else of single triangles
  bool writes_depth = true;
  /// Draws where it is nearer than what is there, or as near, too.
  bool draws_as_near = false;
  std::span<const VkPipelineColorBlendAttachmentState> images = {};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkRenderPass pass = VK_NULL_HANDLE;
  uint32_t subpass = 0;
};

/// Throws Error.
VulkanHandle<VkPipeline> graphicsPipeline(const VulkanContext& context, const GraphicsPipeline& its);

/// Records viewport and scissor of a whole image.
void setWholeViewport(const VulkanContext& context, VkCommandBuffer commands, uint32_t width,
                      uint32_t height);

}  // namespace sightline
