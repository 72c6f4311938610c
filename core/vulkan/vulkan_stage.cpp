#include "core/vulkan/vulkan_stage.h"

#include <algorithm>
#include <cstring>

#include "core/shared/counters.h"
#include "core/vulkan/vulkan_commands.h"

namespace sightline {
namespace {

/// Stages and groups of a ray tracing pipeline, while it is made.
class RayGroups {
 public:
  explicit RayGroups(const VulkanContext& context) : context_(context) {}

  /// A group of a ray generation or miss shader.
  void general(VkShaderStageFlagBits stage, const std::string& name) {
    group(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR).generalShader = add(stage, name);
  }

  /// A group for triangles.
  void hit(const VulkanRayShaders::HitGroup& shaders) {
    auto& its = group(VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR);
    its.closestHitShader = add(VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, shaders.closest_hit);
    its.anyHitShader = add(VK_SHADER_STAGE_ANY_HIT_BIT_KHR, shaders.any_hit);
  }

  void describe(VkRayTracingPipelineCreateInfoKHR& info) const {
    info.stageCount = static_cast<uint32_t>(stages_.size());
    info.pStages = stages_.data();
    info.groupCount = static_cast<uint32_t>(groups_.size());
    info.pGroups = groups_.data();
  }

 private:
  /// The number of a stage; no name: no stage.
  uint32_t add(VkShaderStageFlagBits stage, const std::string& name) {
    if (name.empty()) return VK_SHADER_UNUSED_KHR;
    modules_.push_back(shaderModule(context_, name));
    stages_.push_back(stageInfo(stage, modules_.back().get()));
    return static_cast<uint32_t>(stages_.size() - 1);
  }

  VkRayTracingShaderGroupCreateInfoKHR& group(VkRayTracingShaderGroupTypeKHR type) {
    auto& info = groups_.emplace_back(vkStruct<VkRayTracingShaderGroupCreateInfoKHR>(
        VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR));
    info.type = type;
    info.generalShader = info.closestHitShader = VK_SHADER_UNUSED_KHR;
    info.anyHitShader = info.intersectionShader = VK_SHADER_UNUSED_KHR;
    return info;
  }

  const VulkanContext& context_;
  std::vector<VulkanHandle<VkShaderModule>> modules_;
  std::vector<VkPipelineShaderStageCreateInfo> stages_;
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups_;
};

/// The first records of a table are those of ray generation and miss; then come the groups of hits.
constexpr uint32_t kHitRecord = 2;

uint64_t alignUp(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

}  // namespace

VulkanHandle<VkShaderModule> shaderModule(const VulkanContext& context, const std::string& name) {
  const std::span<const uint32_t> code = context.shader(name);
  auto info = vkStruct<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = code.size_bytes();
  info.pCode = code.data();
  VkShaderModule module = VK_NULL_HANDLE;
  checkVk(context.api().vkCreateShaderModule(context.device(), &info, nullptr, &module),
          "vkCreateShaderModule");
  return {context, module, [](const VulkanContext& c, VkShaderModule handle) {
            c.api().vkDestroyShaderModule(c.device(), handle, nullptr);
          }};
}

VkPipelineShaderStageCreateInfo stageInfo(VkShaderStageFlagBits stage, VkShaderModule module) {
  auto info = vkStruct<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  info.stage = stage;
  info.module = module;
  info.pName = "main";
  return info;
}

VulkanHandle<VkPipelineLayout> pushLayout(const VulkanContext& context, VkShaderStageFlags stages,
                                          uint32_t bytes) {
  const VkPushConstantRange range{stages, 0, bytes};
  auto info = vkStruct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  checkVk(context.api().vkCreatePipelineLayout(context.device(), &info, nullptr, &layout),
          "vkCreatePipelineLayout");
  return {context, layout, [](const VulkanContext& c, VkPipelineLayout handle) {
            c.api().vkDestroyPipelineLayout(c.device(), handle, nullptr);
          }};
}

void destroyPipeline(const VulkanContext& context, VkPipeline pipeline) {
  context.api().vkDestroyPipeline(context.device(), pipeline, nullptr);
}

VulkanHandle<VkPipeline> computePipeline(const VulkanContext& context, const std::string& name,
                                         VkPipelineLayout layout, const VkSpecializationInfo* constants) {
  const VulkanHandle<VkShaderModule> module = shaderModule(context, name);
  auto info = vkStruct<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = stageInfo(VK_SHADER_STAGE_COMPUTE_BIT, module.get());
  info.stage.pSpecializationInfo = constants;
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  checkVk(
      context.api().vkCreateComputePipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
      ("vkCreateComputePipelines " + name).c_str());
  return {context, pipeline, destroyPipeline};
}

VulkanStage VulkanStage::compute(const VulkanContext& context, const std::string& name, uint32_t group_size) {
  VulkanStage stage;
  stage.context_ = &context;
  stage.createLayout(VK_SHADER_STAGE_COMPUTE_BIT);
  stage.group_size_ = group_size;
  stage.createPipeline(name);
  return stage;
}

VulkanStage VulkanStage::list(const VulkanContext& context, const std::string& name) {
  VulkanStage stage;
  stage.context_ = &context;
  stage.createLayout(VK_SHADER_STAGE_COMPUTE_BIT);
  stage.group_size_ = SL_LIST_GROUP;
  stage.list_name_ = name + ".comp";
  return stage;
}

VulkanStage VulkanStage::rays(const VulkanContext& context, const VulkanRayShaders& shaders) {
  VulkanStage stage;
  stage.context_ = &context;
  const bool asks = std::ranges::any_of(shaders.hits, [](const auto& hit) { return !hit.any_hit.empty(); });
  stage.createLayout(VK_SHADER_STAGE_RAYGEN_BIT_KHR | (asks ? VK_SHADER_STAGE_ANY_HIT_BIT_KHR : 0));
  stage.createRayPipeline(shaders);
  return stage;
}

void VulkanStage::createPipeline(const std::string& name) const {
  const VkSpecializationMapEntry entry{0, 0, sizeof group_size_};
  const VkSpecializationInfo constants{1, &entry, sizeof group_size_, &group_size_};
  pipeline_ = computePipeline(*context_, name, layout_.get(), &constants);
}

void VulkanStage::createRayPipeline(const VulkanRayShaders& shaders) {
  RayGroups groups(*context_);
  groups.general(VK_SHADER_STAGE_RAYGEN_BIT_KHR, shaders.generation);
  groups.general(VK_SHADER_STAGE_MISS_BIT_KHR, shaders.miss);
  for (const VulkanRayShaders::HitGroup& hit : shaders.hits) groups.hit(hit);
  auto info =
      vkStruct<VkRayTracingPipelineCreateInfoKHR>(VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR);
  groups.describe(info);
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  checkVk(context_->api().vkCreateRayTracingPipelinesKHR(context_->device(), VK_NULL_HANDLE, VK_NULL_HANDLE,
                                                         1, &info, nullptr, &pipeline),
          ("vkCreateRayTracingPipelinesKHR " + shaders.generation).c_str());
  pipeline_ = {*context_, pipeline, destroyPipeline};
  readTable(info.groupCount);
}

void VulkanStage::readTable(uint32_t groups) {
  // One record a group, each at a multiple of the base alignment.
  const VulkanLimits& limits = context_->limits();
  table_stride_ = alignUp(limits.handle_bytes, limits.table_alignment);
  std::vector<char> handles(groups * limits.handle_bytes);
  table_records_.resize(groups * table_stride_);
  checkVk(context_->api().vkGetRayTracingShaderGroupHandlesKHR(context_->device(), pipeline_.get(), 0, groups,
                                                               handles.size(), handles.data()),
          "vkGetRayTracingShaderGroupHandlesKHR");
  for (size_t i = 0; i < groups; ++i) {
    std::memcpy(&table_records_[i * table_stride_], &handles[i * limits.handle_bytes], limits.handle_bytes);
  }
}

void VulkanStage::uploadTable() const {
  const uint64_t alignment = context_->limits().table_alignment;
  table_ = context_->buffer(table_records_.size() + alignment, "shader binding table");
  table_start_ = alignUp(table_.address(), alignment);
  VulkanCommands commands(*context_, context_->queue(), context_->queueFamily());
  commands.update(table_, table_records_.data(), table_records_.size(), table_start_ - table_.address());
  commands.finish();
}

void VulkanStage::record(VkCommandBuffer commands, VkDeviceAddress launch, uint32_t count) const {
  compile();
  if (!table_records_.empty() && table_.bytes() == 0) uploadTable();
  const VulkanApi& api = context_->api();
  const VulkanLimits& limits = context_->limits();
  const bool pipelines = group_size_ == 0;
  const uint64_t most = pipelines ? limits.launch_rays : uint64_t(limits.launch_groups) * group_size_;
  api.vkCmdBindPipeline(commands,
                        pipelines ? VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR : VK_PIPELINE_BIND_POINT_COMPUTE,
                        pipeline_.get());
  for (uint64_t first = 0; first < count; first += most) {
    const VulkanPush push{launch, static_cast<uint32_t>(first), count};
    api.vkCmdPushConstants(commands, layout_.get(), stages_, 0, sizeof push, &push);
    const auto items = static_cast<uint32_t>(std::min<uint64_t>(most, count - first));
    if (pipelines) {
      const uint64_t stride = table_stride_;
      const VkStridedDeviceAddressRegionKHR generation{table_start_, stride, stride};
      const VkStridedDeviceAddressRegionKHR miss{table_start_ + stride, stride, stride};
      const uint64_t hits = kHitRecord * stride;
      const VkStridedDeviceAddressRegionKHR hit{table_start_ + hits, stride, table_records_.size() - hits};
      const VkStridedDeviceAddressRegionKHR callable{};
      api.vkCmdTraceRaysKHR(commands, &generation, &miss, &hit, &callable, items, 1, 1);
    } else {
      api.vkCmdDispatch(commands, (items + group_size_ - 1) / group_size_, 1, 1);
    }
  }
}

}  // namespace sightline
