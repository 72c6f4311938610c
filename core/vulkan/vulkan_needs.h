#pragma once
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vulkan/vulkan_api.h"

namespace sightline {

/// What a device may be able to do and a user of it need; it is off unless asked for.
enum class VulkanFeature {
  kStructures,    ///< acceleration structures
  kPipelines,     ///< ray tracing pipelines
  kRayQueries,    ///< in all shaders
  kAddresses,     ///< of buffers, in shaders
  kScalarLayout,  ///< of buffers
  kInt64,         ///< in shaders
  kFloat64,       ///< in shaders
  kMultiview,     ///< several images from one draw
  kClipDistances,
  kMultiDraw,         ///< lists of draws in a buffer
  kDrawCount,         ///< of lists whose length is in a buffer, too
  kFirstInstance,     ///< draws in a buffer that do not start at instance 0
  kQueryReset,        ///< by the host
  kFragmentStores,    ///< to buffers
  kIndependentBlend,  ///< of images that are drawn together
  kMeshShaders,
};
inline constexpr uint32_t kVulkanFeatures = uint32_t(VulkanFeature::kMeshShaders) + 1;

/// SPIR-V of the shader of a name, which must last as long as the program. May throw.
using VulkanShaders = std::span<const uint32_t> (*)(std::string_view name);

/// What a context is to be made for. A device without what is needed is refused in one line that names it.
struct VulkanNeeds {
  VulkanShaders shaders = nullptr;            ///< the program
  std::vector<VulkanFeature> features = {};   ///< all of them
  std::vector<VulkanFeature> one_of = {};     ///< the first of these that the device has; empty: none
  std::vector<VulkanFeature> welcome = {};    ///< those of these that the device has
  std::vector<const char*> extensions = {};   ///< besides those of the features
  VkQueueFlags queue = VK_QUEUE_COMPUTE_BIT;  ///< what one queue must do all of
  uint32_t sub_pixel_bits = 0;                ///< corners must be snapped to 2^-bits pixel or finer
  uint32_t group_size = 0;  ///< invocations that a group of a compute shader must have, in a row
  /// What to say where there is no device at all.
  const char* none =
      "no Vulkan device found: install a driver with ray tracing, or use the devices cpu or opencl";
};

/// What a driver can do.
struct VulkanAbilities {
  uint32_t version = 0;
  std::set<std::string, std::less<>> extensions;
  std::set<VulkanFeature> features;
  std::vector<VkQueueFlags> queues;      ///< by family
  std::vector<uint32_t> timestamp_bits;  ///< of each family; 0: it knows no time
  uint32_t sub_pixel_bits = 0;           ///< subPixelPrecisionBits
  uint32_t group_size = 0;               ///< most invocations of a group, in a row
};

/// Extensions that the feature is one of.
std::span<const char* const> extensionsOf(VulkanFeature feature);

/// Why a device has not got the feature, in one line; empty: it has.
std::string whyLacks(const VulkanAbilities& abilities, VulkanFeature feature);
/// Why a device does not do for the needs, in one line; empty: it does.
std::string whyUnusable(const VulkanAbilities& abilities, const VulkanNeeds& needs);

/// Of a device that does for the needs: the features to turn on.
std::set<VulkanFeature> featuresFor(const VulkanAbilities& abilities, const VulkanNeeds& needs);

/// Vulkan's structs of features, chained: to be filled by the driver or to make a device with. Stays where it
/// is.
class VulkanFeatureChain {
 public:
  /// Structs that belong to other extensions than these are left out.
  explicit VulkanFeatureChain(const std::set<std::string, std::less<>>& extensions);
  VulkanFeatureChain(const VulkanFeatureChain&) = delete;
  VulkanFeatureChain& operator=(const VulkanFeatureChain&) = delete;

  VkPhysicalDeviceFeatures2& first() { return features_; }
  VkBool32& at(VulkanFeature feature);

 private:
  VkPhysicalDeviceFeatures2 features_;
  VkPhysicalDeviceVulkan11Features core11_;
  VkPhysicalDeviceVulkan12Features core12_;
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures_;
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR pipelines_;
  VkPhysicalDeviceRayQueryFeaturesKHR queries_;
  VkPhysicalDeviceMeshShaderFeaturesEXT meshes_;
};

}  // namespace sightline
