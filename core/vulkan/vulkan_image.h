#pragma once
#include "core/vulkan/vulkan_context.h"

namespace sightline {

/// What an image is, in pixels.
struct VulkanImageSize {
  uint32_t width = 1, height = 1, layers = 1;
};

/// A device-local image of layers with a view of all of them; empty by default. Outlives no context.
class VulkanImage {
 public:
  VulkanImage() = default;
  /// what: for the message when it does not fit. Throws Error.
  VulkanImage(const VulkanContext& context, VkFormat format, VkImageUsageFlags usage,
              VkImageAspectFlags aspect, const VulkanImageSize& size, const VulkanMemoryUse& use);

  VkImage get() const { return image_.get(); }
  VkImageView view() const { return view_.get(); }

 private:
  VulkanMemoryBlock memory_;
  VulkanHandle<VkImage> image_;
  VulkanHandle<VkImageView> view_;  // goes first
};

}  // namespace sightline
