#include "core/device/vulkan/vulkan_raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "core/base/error.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/vulkan/graphics_pipeline.h"
#include "core/vulkan/vulkan_stage.h"

namespace sightline {
namespace {

constexpr VkFormat kIdFormat = VK_FORMAT_R32_UINT, kDepthFormat = VK_FORMAT_D32_SFLOAT;
/// A view of its own in each subpass.
constexpr uint32_t kViewMasks[] = {1, 2, 4, 8, 16};
static_assert(std::size(kViewMasks) == kHemicubeViews);

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

/// Around the pass: after all that came before, and before all that follows. Within it one view after the
/// other: each has layers of its own, but the images are the same.
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
  const bool before = from == VK_SUBPASS_EXTERNAL, after = to == VK_SUBPASS_EXTERNAL;
  result.srcStageMask = before ? kAll : kWork;
  result.srcAccessMask = before ? kAnyWrite : kWrites;
  result.dstStageMask = after ? kAll : kWork;
  result.dstAccessMask = after ? kAnyWrite | VK_ACCESS_MEMORY_READ_BIT : kWrites | kReads;
  return result;
}

}  // namespace

VulkanRaster::VulkanRaster(const VulkanContext& context, VulkanRunner& runner, uint32_t resolution,
                           uint32_t triangles)
    : context_(context), runner_(runner), resolution_(resolution) {
  const DeviceInfo& info = context.info();
  if (const std::string why = whyNoHemicubes(context); !why.empty()) {
    throw Error(fmt::format("{} ({}) cannot rasterise: {}", info.id, info.name, why));
  }
  if (resolution > context.limits().image_side) {
    throw Error(
        fmt::format("{} ({}) draws images of {} pixels a side at most; give a smaller "
                    "--raster-resolution than {}",
                    info.id, info.name, context.limits().image_side, resolution));
  }
  createImages();
  createPass();
  createFramebuffer();
  layout_ = pushLayout(context, VK_SHADER_STAGE_VERTEX_BIT);
  createPipelines();
  cull_ = VulkanStage::list(context, "cull_chunks");
  boundChunks(triangles);
}

void VulkanRaster::createImages() {
  const char* remedy = "a smaller --raster-resolution";
  leaves_ = context_.buffer(uint64_t(kHemicubeViews) * resolution_ * resolution_ * 4,
                            {"pixels of a hemicube", remedy});
  ids_ =
      VulkanImage(context_, kIdFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                  VK_IMAGE_ASPECT_COLOR_BIT, {resolution_, resolution_, kHemicubeViews},
                  {"images of a hemicube", remedy});
  depth_ = VulkanImage(context_, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                       VK_IMAGE_ASPECT_DEPTH_BIT, {resolution_, resolution_, kHemicubeViews},
                       {"depth of a hemicube", remedy});
}

void VulkanRaster::boundChunks(uint32_t triangles) {
  VulkanLaunch& launch = runner_.launch;
  launch.triangle_count = triangles;
  launch.chunk_count = (triangles + kChunkTriangles - 1) / kChunkTriangles;
  bounds_ = context_.buffer(uint64_t(launch.chunk_count) * kBoxFloats * 4, "boxes of chunks");
  draws_ =
      context_.buffer(uint64_t(launch.chunk_count) * kHemicubeViews * sizeof(VkDrawIndirectCommand), "draws");
  launch.chunk_bounds = bounds_.address();
  launch.draws = draws_.address();
  launch.raster_leaves = leaves_.address();
  const VulkanStage bound = VulkanStage::list(context_, "chunk_bounds");
  runner_.run(bound, launch.chunk_count);
  runner_.commands.finish();
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
  const std::vector<VkSubpassDescription> subpasses(kHemicubeViews, subpass);
  std::vector<VkSubpassDependency> dependencies;
  for (uint32_t view = 0; view < kHemicubeViews; ++view) {
    dependencies.push_back(dependency(VK_SUBPASS_EXTERNAL, view));
    dependencies.push_back(dependency(view, VK_SUBPASS_EXTERNAL));
    if (view > 0) dependencies.push_back(dependency(view - 1, view));
  }
  auto views = vkStruct<VkRenderPassMultiviewCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_MULTIVIEW_CREATE_INFO);
  views.subpassCount = kHemicubeViews;
  views.pViewMasks = kViewMasks;
  auto info = vkStruct<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.pNext = &views;
  info.attachmentCount = 2;
  info.pAttachments = attachments;
  info.subpassCount = kHemicubeViews;
  info.pSubpasses = subpasses.data();
  info.dependencyCount = static_cast<uint32_t>(dependencies.size());
  info.pDependencies = dependencies.data();
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

void VulkanRaster::createPipelines() {
  VkPipelineColorBlendAttachmentState write{};
  write.colorWriteMask = VK_COLOR_COMPONENT_R_BIT;
  for (uint32_t view = 0; view < kHemicubeViews; ++view) {  // of equally near leaves the first is drawn
    pipelines_[view] = graphicsPipeline(context_, {.vertex = "hemicube.vert",
                                                   .fragment = "hemicube.frag",
                                                   .images = {&write, 1},
                                                   .layout = layout_.get(),
                                                   .pass = pass_.get(),
                                                   .subpass = view});
  }
}

void VulkanRaster::draw() {
  const uint32_t chunks = runner_.launch.chunk_count;
  runner_.run(cull_, chunks * kHemicubeViews);
  const VulkanApi& api = context_.api();
  const VulkanPush push{runner_.recordLaunch(), 0, 0};
  const VkCommandBuffer buffer = runner_.commands.next();
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
  setWholeViewport(context_, buffer, resolution_, resolution_);
  for (uint32_t view = 0; view < kHemicubeViews; ++view) {
    if (view > 0) api.vkCmdNextSubpass(buffer, VK_SUBPASS_CONTENTS_INLINE);
    api.vkCmdBindPipeline(buffer, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_[view].get());
    api.vkCmdPushConstants(buffer, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof push, &push);
    for (uint32_t first = 0; first < chunks; first += std::min(context_.limits().draws, chunks - first)) {
      constexpr uint32_t kStride = sizeof(VkDrawIndirectCommand);
      api.vkCmdDrawIndirect(buffer, draws_.get(), (uint64_t(view) * chunks + first) * kStride,
                            std::min(context_.limits().draws, chunks - first), kStride);
    }
  }
  api.vkCmdEndRenderPass(buffer);

  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, kHemicubeViews};
  region.imageExtent = {resolution_, resolution_, 1};
  api.vkCmdCopyImageToBuffer(runner_.commands.next(), ids_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                             leaves_.get(), 1, &region);
}

}  // namespace sightline
