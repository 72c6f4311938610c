#include "core/device/vulkan_raster.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/device/vulkan_stage.h"
#include "core/error.h"
#include "core/shared/hemicube.h"

namespace sightline {
namespace {

constexpr VkFormat kIdFormat = VK_FORMAT_R32_UINT, kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr uint32_t kViewMask = (1u << kHemicubeViews) - 1;
/// Triangles of one draw: three vertices each are far below what drivers count in 32 bits.
constexpr uint32_t kDrawTriangles = 1u << 24;

VkAttachmentDescription attachment(VkFormat format, VkAttachmentStoreOp store, VkImageLayout layout) {
  VkAttachmentDescription description{};
  description.format = format;
  description.samples = VK_SAMPLE_COUNT_1_BIT;
  description.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  description.storeOp = store;
  description.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  description.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  description.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  description.finalLayout = layout;
  return description;
}

/// Around the pass: after all that came before, and before all that follows.
VkSubpassDependency dependency(uint32_t from, uint32_t to) {
  constexpr VkPipelineStageFlags kTests =
      VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkPipelineStageFlags kAll = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  constexpr VkAccessFlags kAnyWrite = VK_ACCESS_MEMORY_WRITE_BIT;
  constexpr VkPipelineStageFlags kWork = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kTests;
  constexpr VkAccessFlags kWrites =
      VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  constexpr VkAccessFlags kReads = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
  VkSubpassDependency result{};
  result.srcSubpass = from;
  result.dstSubpass = to;
  const bool before = from == VK_SUBPASS_EXTERNAL;
  result.srcStageMask = before ? kAll : kWork;
  result.srcAccessMask = before ? kAnyWrite : kWrites;
  result.dstStageMask = before ? kWork : kAll;
  result.dstAccessMask = before ? kWrites | kReads : kAnyWrite | VK_ACCESS_MEMORY_READ_BIT;
  return result;
}

}  // namespace

VulkanRaster::VulkanRaster(const VulkanContext& context, uint32_t resolution)
    : context_(context), resolution_(resolution) {
  const DeviceInfo& info = context.info();
  if (!context.whyNoRaster().empty()) {
    throw Error(fmt::format("{} ({}) cannot rasterise: {}", info.id, info.name, context.whyNoRaster()));
  }
  if (resolution > context.limits().image_side) {
    throw Error(fmt::format("{} ({}) draws images of {} pixels a side at most, not of {}", info.id, info.name,
                            context.limits().image_side, resolution));
  }
  leaves_ = context.buffer(uint64_t(kHemicubeViews) * resolution * resolution * 4, "pixels of a hemicube");
  ids_ =
      VulkanImage(context, kIdFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                  VK_IMAGE_ASPECT_COLOR_BIT, resolution, kHemicubeViews, "images of a hemicube");
  depth_ = VulkanImage(context, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                       VK_IMAGE_ASPECT_DEPTH_BIT, resolution, kHemicubeViews, "depth of a hemicube");
  createPass();
  createFramebuffer();
  layout_ = pushLayout(context, VK_SHADER_STAGE_VERTEX_BIT);
  createPipeline();
}

void VulkanRaster::createPass() {
  const VkAttachmentDescription attachments[] = {
      attachment(kIdFormat, VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL),
      attachment(kDepthFormat, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                 VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL)};
  const VkAttachmentReference ids{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &ids;
  subpass.pDepthStencilAttachment = &depth;
  const VkSubpassDependency dependencies[] = {dependency(VK_SUBPASS_EXTERNAL, 0),
                                              dependency(0, VK_SUBPASS_EXTERNAL)};
  auto views = vkStruct<VkRenderPassMultiviewCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_MULTIVIEW_CREATE_INFO);
  views.subpassCount = 1;
  views.pViewMasks = &kViewMask;
  auto info = vkStruct<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.pNext = &views;
  info.attachmentCount = 2;
  info.pAttachments = attachments;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = 2;
  info.pDependencies = dependencies;
  VkRenderPass pass = VK_NULL_HANDLE;
  checkVk(context_.api().vkCreateRenderPass(context_.device(), &info, nullptr, &pass), "vkCreateRenderPass");
  pass_ = {context_, pass, [](const VulkanContext& c, VkRenderPass handle) {
             c.api().vkDestroyRenderPass(c.device(), handle, nullptr);
           }};
}

void VulkanRaster::createFramebuffer() {
  const VkImageView attachments[] = {ids_.view(), depth_.view()};
  auto info = vkStruct<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
  info.renderPass = pass_.get();
  info.attachmentCount = 2;
  info.pAttachments = attachments;
  info.width = info.height = resolution_;
  info.layers = 1;  // as it is with several views
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  checkVk(context_.api().vkCreateFramebuffer(context_.device(), &info, nullptr, &framebuffer),
          "vkCreateFramebuffer");
  framebuffer_ = {context_, framebuffer, [](const VulkanContext& c, VkFramebuffer handle) {
                    c.api().vkDestroyFramebuffer(c.device(), handle, nullptr);
                  }};
}

void VulkanRaster::createPipeline() {
  const VulkanHandle<VkShaderModule> vertex = shaderModule(context_, "hemicube.vert");
  const VulkanHandle<VkShaderModule> fragment = shaderModule(context_, "hemicube.frag");
  const VkPipelineShaderStageCreateInfo stages[] = {stageInfo(VK_SHADER_STAGE_VERTEX_BIT, vertex.get()),
                                                    stageInfo(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get())};
  const auto input = vkStruct<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);  // the shader reads the corners itself
  auto assembly = vkStruct<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  const auto side = static_cast<float>(resolution_);
  const VkViewport view{0, 0, side, side, 0, 1};
  const VkRect2D area{{0, 0}, {resolution_, resolution_}};
  auto viewport =
      vkStruct<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  viewport.pViewports = &view;
  viewport.pScissors = &area;
  auto raster = vkStruct<VkPipelineRasterizationStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = VK_CULL_MODE_NONE;
  raster.lineWidth = 1;
  auto samples = vkStruct<VkPipelineMultisampleStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  auto depth = vkStruct<VkPipelineDepthStencilStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;  // of equal ones the first leaf
  VkPipelineColorBlendAttachmentState write{};
  write.colorWriteMask = VK_COLOR_COMPONENT_R_BIT;
  auto blend =
      vkStruct<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = 1;
  blend.pAttachments = &write;
  auto info = vkStruct<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.layout = layout_.get();
  info.renderPass = pass_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  checkVk(context_.api().vkCreateGraphicsPipelines(context_.device(), VK_NULL_HANDLE, 1, &info, nullptr,
                                                   &pipeline),
          "vkCreateGraphicsPipelines");
  pipeline_ = {context_, pipeline, destroyPipeline};
}

void VulkanRaster::record(VulkanCommands& commands, VkDeviceAddress launch, uint32_t triangles) const {
  const VulkanApi& api = context_.api();
  const VkCommandBuffer buffer = commands.next();
  VkClearValue clear[2]{};
  clear[0].color.uint32[0] = kNoTriangle;
  clear[1].depthStencil.depth = 0;  // as far as can be
  auto begin = vkStruct<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  begin.renderPass = pass_.get();
  begin.framebuffer = framebuffer_.get();
  begin.renderArea = {{0, 0}, {resolution_, resolution_}};
  begin.clearValueCount = 2;
  begin.pClearValues = clear;
  api.vkCmdBeginRenderPass(buffer, &begin, VK_SUBPASS_CONTENTS_INLINE);
  api.vkCmdBindPipeline(buffer, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
  for (uint32_t first = 0; first < triangles; first += std::min(kDrawTriangles, triangles - first)) {
    const uint32_t count = std::min(kDrawTriangles, triangles - first);
    const VulkanPush push{launch, first, first + count};
    api.vkCmdPushConstants(buffer, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof push, &push);
    api.vkCmdDraw(buffer, 3 * count, 1, 0, 0);
  }
  api.vkCmdEndRenderPass(buffer);

  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, kHemicubeViews};
  region.imageExtent = {resolution_, resolution_, 1};
  api.vkCmdCopyImageToBuffer(commands.next(), ids_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, leaves_.get(),
                             1, &region);
}

}  // namespace sightline
