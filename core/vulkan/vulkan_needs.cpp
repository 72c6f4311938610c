#include "core/vulkan/vulkan_needs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sightline {
namespace {

/// What is told of a feature.
struct Description {
  std::vector<const char*> extensions;
  const char* lack;  ///< what there is not without it
  const char* name;  ///< Vulkan's
};

const Description& descriptionOf(VulkanFeature feature) {
  static const Description kDescriptions[kVulkanFeatures] = {
      {{VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME},
       "ray tracing",
       "accelerationStructure"},
      {{VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME}, "ray tracing pipelines", "rayTracingPipeline"},
      {{VK_KHR_RAY_QUERY_EXTENSION_NAME}, "ray queries", "rayQuery"},
      {{}, "addresses of buffers in shaders", "bufferDeviceAddress"},
      {{}, "scalar layout of buffers", "scalarBlockLayout"},
      {{}, "64-bit integers in shaders", "shaderInt64"},
      {{}, "64-bit floats in shaders", "shaderFloat64"},
      {{}, "images of several views", "multiview"},
      {{}, "clip distances in shaders", "shaderClipDistance"},
      {{}, "lists of draws", "multiDrawIndirect"},
      {{}, "lists of draws with their length", "drawIndirectCount"},
      {{}, "lists of draws of any instance", "drawIndirectFirstInstance"},
      {{}, "queries that the host resets", "hostQueryReset"},
      {{}, "fragment shaders that write to buffers", "fragmentStoresAndAtomics"},
      {{}, "blending in one image of several", "independentBlend"},
      {{VK_EXT_MESH_SHADER_EXTENSION_NAME}, "mesh shaders", "meshShader"},
  };
  return kDescriptions[uint32_t(feature)];
}

std::string queueText(VkQueueFlags flags) {
  std::string text;
  for (const auto& [flag, name] : {std::pair(VK_QUEUE_GRAPHICS_BIT, "graphics"),
                                   {VK_QUEUE_COMPUTE_BIT, "compute shaders"},
                                   {VK_QUEUE_TRANSFER_BIT, "copies"}}) {
    if (flags & flag) text += (text.empty() ? "" : " and ") + std::string(name);
  }
  return text;
}

}  // namespace

std::span<const char* const> extensionsOf(VulkanFeature feature) {
  return descriptionOf(feature).extensions;
}

std::string whyLacks(const VulkanAbilities& abilities, VulkanFeature feature) {
  const Description& its = descriptionOf(feature);
  for (const char* extension : its.extensions) {
    if (!abilities.extensions.contains(extension)) {
      return fmt::format("no {}: its driver lacks {}", its.lack, extension);
    }
  }
  return abilities.features.contains(feature) ? std::string() : fmt::format("no {} ({})", its.lack, its.name);
}

std::string whyUnusable(const VulkanAbilities& abilities, const VulkanNeeds& needs) {
  if (abilities.version < VK_API_VERSION_1_2) {
    return fmt::format("its driver knows Vulkan {}.{}, 1.2 is needed",
                       VK_API_VERSION_MAJOR(abilities.version), VK_API_VERSION_MINOR(abilities.version));
  }
  for (const VulkanFeature feature : needs.features) {
    if (const std::string why = whyLacks(abilities, feature); !why.empty()) return why;
  }
  std::string lacking;
  for (const VulkanFeature feature : needs.one_of) {
    const std::string why = whyLacks(abilities, feature);
    if (why.empty()) {
      lacking.clear();
      break;
    }
    lacking += (lacking.empty() ? "" : ", and ") + why;
  }
  if (!lacking.empty()) return lacking;
  for (const char* extension : needs.extensions) {
    if (!abilities.extensions.contains(extension)) return fmt::format("its driver lacks {}", extension);
  }
  const bool queue = std::any_of(abilities.queues.begin(), abilities.queues.end(),
                                 [&](VkQueueFlags flags) { return (flags & needs.queue) == needs.queue; });
  if (!queue) return "no queue for " + queueText(needs.queue);
  if (abilities.sub_pixel_bits < needs.sub_pixel_bits) {
    return fmt::format("it knows places in a pixel to {} bits (subPixelPrecisionBits), {} are needed",
                       abilities.sub_pixel_bits, needs.sub_pixel_bits);
  }
  if (abilities.group_size < needs.group_size) {
    return fmt::format(
        "its groups of compute shaders hold {} invocations (maxComputeWorkGroupSize), {} are needed",
        abilities.group_size, needs.group_size);
  }
  return "";
}

std::set<VulkanFeature> featuresFor(const VulkanAbilities& abilities, const VulkanNeeds& needs) {
  const auto has = [&](VulkanFeature feature) { return whyLacks(abilities, feature).empty(); };
  std::set<VulkanFeature> features(needs.features.begin(), needs.features.end());
  const auto one = std::find_if(needs.one_of.begin(), needs.one_of.end(), has);
  if (one != needs.one_of.end()) features.insert(*one);
  for (const VulkanFeature feature : needs.welcome) {
    if (has(feature)) features.insert(feature);
  }
  return features;
}

VulkanFeatureChain::VulkanFeatureChain(const std::set<std::string, std::less<>>& extensions)
    : features_(vkStruct<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2)),
      core11_(
          vkStruct<VkPhysicalDeviceVulkan11Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES)),
      core12_(
          vkStruct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES)),
      structures_(vkStruct<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR)),
      pipelines_(vkStruct<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR)),
      queries_(vkStruct<VkPhysicalDeviceRayQueryFeaturesKHR>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR)),
      meshes_(vkStruct<VkPhysicalDeviceMeshShaderFeaturesEXT>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT)) {
  features_.pNext = &core11_;
  core11_.pNext = &core12_;
  const auto chain = [&](auto& its, const char* extension) {
    if (extensions.contains(extension)) its.pNext = std::exchange(core12_.pNext, &its);
  };
  chain(structures_, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
  chain(pipelines_, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
  chain(queries_, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  chain(meshes_, VK_EXT_MESH_SHADER_EXTENSION_NAME);
}

VkBool32& VulkanFeatureChain::at(VulkanFeature feature) {
  switch (feature) {
    case VulkanFeature::kStructures:
      return structures_.accelerationStructure;
    case VulkanFeature::kPipelines:
      return pipelines_.rayTracingPipeline;
    case VulkanFeature::kRayQueries:
      return queries_.rayQuery;
    case VulkanFeature::kAddresses:
      return core12_.bufferDeviceAddress;
    case VulkanFeature::kScalarLayout:
      return core12_.scalarBlockLayout;
    case VulkanFeature::kInt64:
      return features_.features.shaderInt64;
    case VulkanFeature::kFloat64:
      return features_.features.shaderFloat64;
    case VulkanFeature::kMultiview:
      return core11_.multiview;
    case VulkanFeature::kClipDistances:
      return features_.features.shaderClipDistance;
    case VulkanFeature::kDrawCount:
      return core12_.drawIndirectCount;
    case VulkanFeature::kFirstInstance:
      return features_.features.drawIndirectFirstInstance;
    case VulkanFeature::kQueryReset:
      return core12_.hostQueryReset;
    case VulkanFeature::kFragmentStores:
      return features_.features.fragmentStoresAndAtomics;
    case VulkanFeature::kIndependentBlend:
      return features_.features.independentBlend;
    case VulkanFeature::kMeshShaders:
      return meshes_.meshShader;
    case VulkanFeature::kMultiDraw:
      break;
  }
  return features_.features.multiDrawIndirect;
}

}  // namespace sightline
