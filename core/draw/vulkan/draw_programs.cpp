#include "core/draw/vulkan/draw_programs.h"

#include "core/vulkan/graphics_pipeline.h"

namespace sightline {
namespace {

struct Shaders {
  const char* vertex;
  const char* fragment;  ///< nullptr: none
};

Shaders shadersOf(DrawKind kind) {
  switch (kind) {
    case DrawKind::masked:
      return {"plain.vert", "plain.frag"};
    case DrawKind::glass:
      return {"plain.vert", "glass.frag"};
    case DrawKind::meshlets:
      return {"meshlet.mesh", "object.frag"};
    case DrawKind::query_box:
      return {"box.vert", nullptr};
    case DrawKind::unit_box:
      return {"unit_box.vert", "box.frag"};
    case DrawKind::opaque:
      break;
  }
  return {"object.vert", "object.frag"};
}

/// What the images of numbers and of glass get of it.
std::array<VkPipelineColorBlendAttachmentState, 2> blendingOf(DrawKind kind) {
  std::array<VkPipelineColorBlendAttachmentState, 2> images{};
  if (kind == DrawKind::opaque || kind == DrawKind::masked || kind == DrawKind::meshlets) {
    images[0].colorWriteMask = VK_COLOR_COMPONENT_R_BIT;
  }
  if (kind == DrawKind::glass) {  // its alpha counts what is let through
    images[1].blendEnable = VK_TRUE;
    images[1].srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
    images[1].dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    images[1].srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
    images[1].dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    images[1].colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                               VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  }
  return images;
}

}  // namespace

DrawPrograms::DrawPrograms(const VulkanContext& context, const DrawPasses& passes)
    : context_(context),
      passes_(passes),
      stages_(
          VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT |
          (context.has(VulkanFeature::kMeshShaders) ? VkShaderStageFlags(VK_SHADER_STAGE_MESH_BIT_EXT) : 0)),
      layout_(pushLayout(context, stages_, sizeof(DrawPush))) {}

void DrawPrograms::bind(VkCommandBuffer commands, DrawKind kind, const DrawPush& push) {
  context_.api().vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, graphics(kind));
  context_.api().vkCmdPushConstants(commands, layout_.get(), stages_, 0, sizeof push, &push);
}

void DrawPrograms::run(VkCommandBuffer commands, const char* name, const DrawPush& push, uint32_t groups_x,
                       uint32_t groups_y) {
  context_.api().vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compute(name));
  context_.api().vkCmdPushConstants(commands, layout_.get(), stages_, 0, sizeof push, &push);
  context_.api().vkCmdDispatch(commands, groups_x, groups_y, 1);
}

VkPipeline DrawPrograms::compute(const char* name) {
  VulkanHandle<VkPipeline>& made = compute_[name];
  if (made.get() == VK_NULL_HANDLE) made = computePipeline(context_, name, layout_.get());
  return made.get();
}

VkPipeline DrawPrograms::graphics(DrawKind kind) {
  VulkanHandle<VkPipeline>& made = graphics_[kind];
  if (made.get() != VK_NULL_HANDLE) return made.get();
  const Shaders names = shadersOf(kind);
  const bool boxes = kind == DrawKind::query_box || kind == DrawKind::unit_box;
  const auto images = blendingOf(kind);
  made = graphicsPipeline(context_, {.vertex = names.vertex,
                                     .fragment = names.fragment == nullptr ? "" : names.fragment,
                                     .mesh = kind == DrawKind::meshlets,
                                     .strips = boxes,
                                     .writes_depth = !boxes && kind != DrawKind::glass,
                                     .draws_as_near = boxes,
                                     .images = std::span(images).first(passes_.glass() ? 2 : 1),
                                     .layout = layout_.get(),
                                     .pass = passes_.clearing()});
  return made.get();
}

}  // namespace sightline
