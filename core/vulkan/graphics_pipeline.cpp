#include "core/vulkan/graphics_pipeline.h"

#include <vector>

#include "core/vulkan/vulkan_stage.h"

namespace sightline {

VulkanHandle<VkPipeline> graphicsPipeline(const VulkanContext& context, const GraphicsPipeline& its) {
  const VulkanHandle<VkShaderModule> vertex = shaderModule(context, its.vertex);
  VulkanHandle<VkShaderModule> fragment;
  std::vector<VkPipelineShaderStageCreateInfo> stages = {
      stageInfo(its.mesh ? VK_SHADER_STAGE_MESH_BIT_EXT : VK_SHADER_STAGE_VERTEX_BIT, vertex.get())};
  if (!its.fragment.empty()) {
    fragment = shaderModule(context, its.fragment);
    stages.push_back(stageInfo(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get()));
  }
  const auto input = vkStruct<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  auto assembly = vkStruct<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = its.strips ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
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
  depth.depthWriteEnable = its.writes_depth ? VK_TRUE : VK_FALSE;
  depth.depthCompareOp = its.draws_as_near ? VK_COMPARE_OP_GREATER_OR_EQUAL : VK_COMPARE_OP_GREATER;
  auto blend =
      vkStruct<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = static_cast<uint32_t>(its.images.size());
  blend.pAttachments = its.images.data();
  auto info = vkStruct<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  if (!its.mesh) {
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
  }
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = its.layout;
  info.renderPass = its.pass;
  info.subpass = its.subpass;
  VkPipeline pipeline = VK_NULL_HANDLE;
  checkVk(
      context.api().vkCreateGraphicsPipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
      "vkCreateGraphicsPipelines");
  return {context, pipeline, destroyPipeline};
}

void setWholeViewport(const VulkanContext& context, VkCommandBuffer commands, uint32_t width,
                      uint32_t height) {
  const VkViewport viewport{0, 0, float(width), float(height), 0, 1};
  const VkRect2D scissor{{0, 0}, {width, height}};
  context.api().vkCmdSetViewport(commands, 0, 1, &viewport);
  context.api().vkCmdSetScissor(commands, 0, 1, &scissor);
}

}  // namespace sightline
