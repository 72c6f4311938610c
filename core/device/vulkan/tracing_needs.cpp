#include "core/device/vulkan/tracing_needs.h"

#include "vk_shaders/shaders.h"

namespace sightline {
namespace {

/// What hemicubes take besides a queue for graphics.
const std::vector<VulkanFeature> kDrawing = {VulkanFeature::kMultiview, VulkanFeature::kClipDistances,
                                             VulkanFeature::kMultiDraw};

}  // namespace

VulkanNeeds tracingNeeds(bool ray_queries) {
  using enum VulkanFeature;
  VulkanNeeds needs;
  needs.shaders = shaderCode;
  needs.features = {kStructures, kAddresses, kScalarLayout, kInt64, kFloat64};
  needs.one_of = ray_queries ? std::vector{kRayQueries} : std::vector{kPipelines, kRayQueries};
  needs.welcome = kDrawing;
  return needs;
}

bool usesPipelines(const VulkanContext& context) {
  return context.has(VulkanFeature::kPipelines);
}

const char* vulkanLayout(bool pipelines) {
  return pipelines ? "driver's own tree, ray tracing pipelines" : "driver's own tree, ray queries";
}

VulkanStage tracingStage(const VulkanContext& context, const std::string& name, uint32_t group_size) {
  if (!usesPipelines(context)) return VulkanStage::compute(context, name + ".comp", group_size);
  return VulkanStage::rays(context, name + ".rgen", "nothing.rmiss", "nearest.rchit");
}

VulkanStage tracingStage(const VulkanContext& context, const std::string& name, uint32_t group_size,
                         const SurfaceFeatures& features) {
  if (!features.any()) return tracingStage(context, name, group_size);
  return VulkanStage::compute(context, name + (features.glass ? ".glass.comp" : ".surfaces.comp"),
                              group_size);
}

std::string whyNoHemicubes(const VulkanContext& context) {
  if ((context.queueFlags() & VK_QUEUE_GRAPHICS_BIT) == 0) return "no queue for graphics";
  for (const VulkanFeature feature : kDrawing) {
    if (!context.has(feature)) return whyLacks(context.abilities(), feature);
  }
  return {};
}

}  // namespace sightline
