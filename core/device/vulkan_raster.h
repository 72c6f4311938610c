#pragma once
#include "core/device/vulkan_commands.h"
#include "core/device/vulkan_image.h"

namespace sightline {

/// Draws hemicubes: the scene's triangles into five images at once (multiview), each pixel the leaf that it
/// shows. A depth buffer of 32-bit floats with reversed z and no far plane; triangles are seen from both
/// sides.
class VulkanRaster {
 public:
  /// Throws Error where the device cannot.
  VulkanRaster(const VulkanContext& context, uint32_t resolution);

  uint32_t resolution() const { return resolution_; }
  /// Leaves, image after image, row after row from the top; kNoTriangle where nothing is seen.
  const VulkanBuffer& leaves() const { return leaves_; }

  /// Records the drawing of the launch's hemicube; launch: address of the VulkanLaunch.
  void record(VulkanCommands& commands, VkDeviceAddress launch, uint32_t triangles) const;

 private:
  void createPass();
  void createFramebuffer();
  void createPipeline();

  const VulkanContext& context_;
  uint32_t resolution_;
  VulkanImage ids_, depth_;
  VulkanBuffer leaves_;
  VulkanHandle<VkRenderPass> pass_;
  VulkanHandle<VkFramebuffer> framebuffer_;
  VulkanHandle<VkPipelineLayout> layout_;
  VulkanHandle<VkPipeline> pipeline_;
};

}  // namespace sightline
