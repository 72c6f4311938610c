#include "core/draw/vulkan/draw_passes.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/vulkan/graphics_pipeline.h"
#include "vk_shaders/draw_launch.h"

namespace sightline {
namespace {

constexpr VkFormat kIds = VK_FORMAT_R32_UINT, kDepth = VK_FORMAT_D32_SFLOAT,
                   kGlass = VK_FORMAT_R8G8B8A8_UNORM;

VkAttachmentDescription attachmentOf(VkFormat format, bool clear) {
  VkAttachmentDescription description{};
  description.format = format;
  description.samples = VK_SAMPLE_COUNT_1_BIT;
  description.loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
  description.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  description.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  description.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  description.initialLayout = clear ? VK_IMAGE_LAYOUT_UNDEFINED : VK_IMAGE_LAYOUT_GENERAL;
  description.finalLayout = VK_IMAGE_LAYOUT_GENERAL;
  return description;
}

constexpr VkPipelineStageFlags kDrawStages = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                             VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                             VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags kDrawWrites =
    VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kDrawReads =
    VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;

VulkanHandle<VkRenderPass> makePass(const VulkanContext& context, bool glass, bool clear) {
  const VkAttachmentDescription attachments[] = {attachmentOf(kIds, clear), attachmentOf(kDepth, clear),
                                                 attachmentOf(kGlass, clear)};
  const VkAttachmentReference colours[] = {{0, VK_IMAGE_LAYOUT_GENERAL}, {2, VK_IMAGE_LAYOUT_GENERAL}};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_GENERAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = glass ? 2 : 1;
  subpass.pColorAttachments = colours;
  subpass.pDepthStencilAttachment = &depth;
  VkSubpassDependency before{}, after{};
  before.srcSubpass = after.dstSubpass = VK_SUBPASS_EXTERNAL;
  before.srcStageMask = after.dstStageMask = kDrawStages | VK_PIPELINE_STAGE_TRANSFER_BIT;
  before.dstStageMask = after.srcStageMask = kDrawStages;
  before.srcAccessMask = after.srcAccessMask = kDrawWrites;
  before.dstAccessMask = kDrawReads | kDrawWrites;
  after.dstAccessMask = kDrawReads | kDrawWrites | VK_ACCESS_TRANSFER_READ_BIT;
  const VkSubpassDependency dependencies[] = {before, after};
  auto info = vkStruct<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.attachmentCount = glass ? 3 : 2;
  info.pAttachments = attachments;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = 2;
  info.pDependencies = dependencies;
  VkRenderPass pass = VK_NULL_HANDLE;
  checkVk(context.api().vkCreateRenderPass(context.device(), &info, nullptr, &pass), "vkCreateRenderPass");
  return {context, pass, [](const VulkanContext& c, VkRenderPass handle) {
            c.api().vkDestroyRenderPass(c.device(), handle, nullptr);
          }};
}

}  // namespace

DrawPasses::DrawPasses(const VulkanContext& context, bool glass)
    : glass_(glass), clearing_(makePass(context, glass, true)), loading_(makePass(context, glass, false)) {}

DrawTarget::DrawTarget(const VulkanContext& context, const DrawPasses& passes, uint32_t width,
                       uint32_t height)
    : width_(width), height_(height) {
  const DeviceInfo& info = context.info();
  const uint32_t most = context.limits().image_side;
  if (width > most || height > most) {
    throw Error(fmt::format(
        "{} ({}) draws images of {} pixels a side at most, not {} x {}; give a smaller resolution", info.id,
        info.name, most, width, height));
  }
  const std::string what = fmt::format("images of {} x {} pixels", width, height);
  const VulkanMemoryUse use(what.c_str(), "a smaller resolution");
  const VulkanImageSize size{width, height, 1};
  const VkImageUsageFlags colour = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  ids_ = VulkanImage(context, kIds, colour, VK_IMAGE_ASPECT_COLOR_BIT, size, use);
  depth_ = VulkanImage(context, kDepth,
                       VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                       VK_IMAGE_ASPECT_DEPTH_BIT, size, use);
  if (passes.glass()) glass_ = VulkanImage(context, kGlass, colour, VK_IMAGE_ASPECT_COLOR_BIT, size, use);
  const VkImageView views[] = {ids_.view(), depth_.view(), glass_.view()};
  auto frame = vkStruct<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
  frame.renderPass = passes.clearing();
  frame.attachmentCount = passes.glass() ? 3 : 2;
  frame.pAttachments = views;
  frame.width = width;
  frame.height = height;
  frame.layers = 1;
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  checkVk(context.api().vkCreateFramebuffer(context.device(), &frame, nullptr, &framebuffer),
          "vkCreateFramebuffer");
  framebuffer_ = {context, framebuffer, [](const VulkanContext& c, VkFramebuffer handle) {
                    c.api().vkDestroyFramebuffer(c.device(), handle, nullptr);
                  }};
}

void DrawTarget::begin(const VulkanContext& context, VkCommandBuffer commands, const DrawPasses& passes,
                       bool clear) const {
  VkClearValue values[3]{};
  values[0].color.uint32[0] = kNoDrawable;
  values[1].depthStencil.depth = 0;
  values[2].color.float32[3] = 1;
  auto begin = vkStruct<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  begin.renderPass = clear ? passes.clearing() : passes.loading();
  begin.framebuffer = framebuffer_.get();
  begin.renderArea = {{0, 0}, {width_, height_}};
  begin.clearValueCount = clear ? (passes.glass() ? 3 : 2) : 0;
  begin.pClearValues = values;
  context.api().vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  setWholeViewport(context, commands, width_, height_);
}

void DrawTarget::copy(const VulkanContext& context, VkCommandBuffer commands, Image image,
                      const VulkanBuffer& to) const {
  const VulkanImage& from = image == Image::ids ? ids_ : image == Image::depth ? depth_ : glass_;
  VkBufferImageCopy region{};
  region.imageSubresource = {
      VkImageAspectFlags(image == Image::depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 0,
      1};
  region.imageExtent = {width_, height_, 1};
  auto change = vkStruct<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  change.srcAccessMask = kDrawWrites;
  change.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  change.oldLayout = VK_IMAGE_LAYOUT_GENERAL;
  change.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  change.srcQueueFamilyIndex = change.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  change.image = from.get();
  change.subresourceRange = {region.imageSubresource.aspectMask, 0, 1, 0, 1};
  const VulkanApi& api = context.api();
  api.vkCmdPipelineBarrier(commands, kDrawStages, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr,
                           1, &change);
  api.vkCmdCopyImageToBuffer(commands, from.get(), change.newLayout, to.get(), 1, &region);
  std::swap(change.oldLayout, change.newLayout);
  change.srcAccessMask = 0;
  change.dstAccessMask = kDrawReads | kDrawWrites;
  api.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, kDrawStages, 0, 0, nullptr, 0, nullptr,
                           1, &change);
}

}  // namespace sightline
