#pragma once
#include <array>

#include "core/device/vulkan/vulkan_runner.h"
#include "core/shared/hemicube.h"
#include "core/vulkan/vulkan_image.h"

namespace sightline {

/// Draws hemicubes: the scene's triangles into five images in one render pass, each pixel the leaf that it
/// shows. Each view draws those chunks of leaves that it may show. A depth buffer of 32-bit floats with
/// reversed z and no far plane; triangles are seen from both sides.
class VulkanRaster {
 public:
  /// The runner's launch describes a scene of so many triangles. Throws Error where the device cannot.
  VulkanRaster(const VulkanContext& context, VulkanRunner& runner, uint32_t resolution, uint32_t triangles);

  uint32_t resolution() const { return resolution_; }

  /// Records the drawing of the launch's hemicube; the leaves arrive at the launch's raster_leaves, image
  /// after image, row after row from the top, kNoTriangle where nothing is seen.
  void draw();

 private:
  void createImages();
  void createPass();
  void createFramebuffer();
  void createPipelines();
  void boundChunks(uint32_t triangles);

  const VulkanContext& context_;
  VulkanRunner& runner_;
  uint32_t resolution_;
  VulkanImage ids_, depth_;
  VulkanBuffer leaves_, bounds_, draws_;
  VulkanStage cull_;
  VulkanHandle<VkRenderPass> pass_;  ///< a subpass a view
  VulkanHandle<VkFramebuffer> framebuffer_;
  VulkanHandle<VkPipelineLayout> layout_;
  std::array<VulkanHandle<VkPipeline>, kHemicubeViews> pipelines_;
};

}  // namespace sightline
