#include "core/vulkan/vulkan_image.h"

namespace sightline {

VulkanImage::VulkanImage(const VulkanContext& context, VkFormat format, VkImageUsageFlags usage,
                         VkImageAspectFlags aspect, const VulkanImageSize& size, const VulkanMemoryUse& use) {
  const VulkanApi& api = context.api();
  auto info = vkStruct<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {size.width, size.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = size.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage;
  VkImage image = VK_NULL_HANDLE;
  checkVk(api.vkCreateImage(context.device(), &info, nullptr, &image), "vkCreateImage");
  image_ = {context, image, [](const VulkanContext& c, VkImage handle) {
              c.api().vkDestroyImage(c.device(), handle, nullptr);
            }};
  VkMemoryRequirements requirements{};
  api.vkGetImageMemoryRequirements(context.device(), image, &requirements);
  memory_ = context.allocate(requirements.size, requirements, VulkanMemory::kDevice, use);
  checkVk(api.vkBindImageMemory(context.device(), image, memory_.get(), 0), "vkBindImageMemory");

  auto view_info = vkStruct<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view_info.image = image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY;
  view_info.format = format;
  view_info.subresourceRange = {aspect, 0, 1, 0, size.layers};
  VkImageView view = VK_NULL_HANDLE;
  checkVk(api.vkCreateImageView(context.device(), &view_info, nullptr, &view), "vkCreateImageView");
  view_ = {context, view, [](const VulkanContext& c, VkImageView handle) {
             c.api().vkDestroyImageView(c.device(), handle, nullptr);
           }};
}

}  // namespace sightline
