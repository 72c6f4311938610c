#pragma once
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/trace/device_info.h"
#include "core/vulkan/vulkan_instance.h"

namespace sightline {

/// What a driver can do, as far as tracing needs it.
struct VulkanAbilities {
  uint32_t version = 0;
  std::set<std::string, std::less<>> extensions;
  bool structures = false;   ///< acceleration structures
  bool pipelines = false;    ///< ray tracing pipelines
  bool ray_queries = false;  ///< in compute shaders
  bool addresses = false;    ///< of buffers
  bool scalar_layout = false;
  bool int64 = false, float64 = false;  ///< in shaders
  // Needed by rasterising alone.
  bool multiview = false;       ///< several images from one draw
  bool clip_distances = false;  ///< in shaders
  bool multi_draw = false;      ///< lists of draws in a buffer
};

/// Why a device cannot trace, in one line; empty: it can.
std::string whyUnusable(const VulkanAbilities& abilities);

/// DeviceInfo::layout.
std::string vulkanLayout(bool pipelines);

/// A physical device.
struct VulkanDeviceChoice {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  VulkanAbilities abilities;
  DeviceInfo info;
};

/// Every physical device of the process's instance, in the order of its index in "vulkan:INDEX"; unusable
/// ones with the reason. Throws Error as VulkanInstance::get does.
std::vector<VulkanDeviceChoice> findVulkanDevices();

/// selector: "vulkan" (a discrete GPU if there is a usable one, else an integrated one, else whatever),
/// "vulkan:INDEX" or "vulkan:PART-OF-NAME" (any case, the first that matches). Throws Error that lists what
/// there is.
VulkanDeviceChoice selectVulkanDevice(const std::string& selector);

/// For `sightline devices`: empty where there is no Vulkan loader or no driver. Never throws.
std::vector<DeviceInfo> listVulkanDevices();

}  // namespace sightline
