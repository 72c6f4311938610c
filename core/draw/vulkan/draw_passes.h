#pragma once
#include "core/vulkan/vulkan_image.h"

namespace sightline {

/// How frames are drawn: into an image of drawables' numbers (R32_UINT) and one of depth (D32, reversed: 0 is
/// as far as can be), and with glass a third, its colour and how much it lets through (R8G8B8A8_UNORM, no
/// colour and all). Between passes and copies images are in the layout GENERAL. Passes wait for each other's
/// drawing and for copies of the images.
class DrawPasses {
 public:
  DrawPasses(const VulkanContext& context, bool glass);
  bool glass() const { return glass_; }
  /// That starts anew, or goes on with what the images hold; one is like the other but for that.
  VkRenderPass clearing() const { return clearing_.get(); }
  VkRenderPass loading() const { return loading_.get(); }

 private:
  bool glass_;
  VulkanHandle<VkRenderPass> clearing_, loading_;
};

/// The images of a frame and what makes a pass draw into them.
class DrawTarget {
 public:
  DrawTarget() = default;
  /// Throws Error in one line with the size and a remedy where the device cannot.
  DrawTarget(const VulkanContext& context, const DrawPasses& passes, uint32_t width, uint32_t height);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  uint64_t pixels() const { return uint64_t(width_) * height_; }

  /// Records the start of a pass, with viewport and scissor.
  void begin(const VulkanContext& context, VkCommandBuffer commands, const DrawPasses& passes,
             bool clear) const;

  enum class Image { ids, depth, glass };
  /// Records the copying of an image to a buffer, four bytes a pixel, row after row from the top. Drawing
  /// comes before it; the caller's barrier comes after it.
  void copy(const VulkanContext& context, VkCommandBuffer commands, Image image,
            const VulkanBuffer& to) const;

 private:
  uint32_t width_ = 0, height_ = 0;
  VulkanImage ids_, depth_, glass_;
  VulkanHandle<VkFramebuffer> framebuffer_;
};

}  // namespace sightline
