#include "core/draw/vulkan/draw_programs.h"

#include <vector>

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
  const VulkanHandle<VkShaderModule> vertex = shaderModule(context_, names.vertex);
  VulkanHandle<VkShaderModule> fragment;
  std::vector<VkPipelineShaderStageCreateInfo> stages = {stageInfo(
      kind == DrawKind::meshlets ? VK_SHADER_STAGE_MESH_BIT_EXT : VK_SHADER_STAGE_VERTEX_BIT, vertex.get())};
  if (names.fragment != nullptr) {
    fragment = shaderModule(context_, names.fragment);
    stages.push_back(stageInfo(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get()));
  }
  const auto input = vkStruct<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);  // the shaders read vertices themselves
  auto assembly = vkStruct<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = boxes ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  auto viewport =
      vkStruct<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  const VkDynamicState sizes[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic =
      vkStruct<VkPipelineDynamicStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = sizes;
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
  depth.depthTestEnable = VK_TRUE;
  depth.depthWriteEnable = boxes || kind == DrawKind::glass ? VK_FALSE : VK_TRUE;
  depth.depthCompareOp = boxes ? VK_COMPARE_OP_GREATER_OR_EQUAL : VK_COMPARE_OP_GREATER;
  const auto images = blendingOf(kind);
  auto blend =
      vkStruct<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = passes_.glass() ? 2 : 1;
  blend.pAttachments = images.data();
  auto info = vkStruct<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = uint32_t(stages.size());
  info.pStages = stages.data();
  if (kind != DrawKind::meshlets) {
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
  }
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_.get();
  info.renderPass = passes_.clearing();
  VkPipeline pipeline = VK_NULL_HANDLE;
  checkVk(context_.api().vkCreateGraphicsPipelines(context_.device(), VK_NULL_HANDLE, 1, &info, nullptr,
                                                   &pipeline),
          "vkCreateGraphicsPipelines");
  made = {context_, pipeline, destroyPipeline};
  return made.get();
}

}  // namespace sightline
