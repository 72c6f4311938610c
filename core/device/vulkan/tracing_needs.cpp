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

VulkanStage tracingStage(const VulkanContext& context, const std::string& name, uint32_t group_size,
                         const SurfaceFeatures& features) {
  const std::string kind = features.glass ? ".glass" : features.any() ? ".surfaces" : "";
  if (!usesPipelines(context)) return VulkanStage::compute(context, name + kind + ".comp", group_size);
  VulkanRayShaders shaders{
      .generation = name + kind + ".rgen", .miss = "nothing" + kind + ".rmiss", .hits = {}};
  shaders.hits.push_back({.closest_hit = "nearest" + kind + ".rchit",
                          .any_hit = features.any() ? "nearest" + kind + ".rahit" : ""});
  if (features.glass) shaders.hits.push_back({.closest_hit = "", .any_hit = "glass.rahit"});
  return VulkanStage::rays(context, shaders);
}

std::string whyNoHemicubes(const VulkanContext& context) {
  if ((context.queueFlags() & VK_QUEUE_GRAPHICS_BIT) == 0) return "no queue for graphics";
  for (const VulkanFeature feature : kDrawing) {
    if (!context.has(feature)) return whyLacks(context.abilities(), feature);
  }
  return {};
}

}  // namespace sightline
