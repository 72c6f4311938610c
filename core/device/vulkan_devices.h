#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/device/device.h"
#include "core/device/vulkan_instance.h"

namespace sightline {

/// A physical device of an instance.
struct VulkanDeviceChoice {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  bool has_pipelines = false;    ///< VK_KHR_ray_tracing_pipeline
  bool has_ray_queries = false;  ///< VK_KHR_ray_query
  DeviceInfo info;
};

/// Every physical device, in the order of its index in "vulkan:INDEX"; unusable ones with the reason.
std::vector<VulkanDeviceChoice> findVulkanDevices(const VulkanInstance& instance);

/// selector: "vulkan" (a discrete GPU if there is a usable one, else an integrated one, else whatever),
/// "vulkan:INDEX" or "vulkan:PART-OF-NAME" (any case, the first that matches). Throws Error that lists what
/// there is.
VulkanDeviceChoice selectVulkanDevice(const VulkanInstance& instance, const std::string& selector);

/// For `sightline devices`: empty where there is no Vulkan loader or no driver. Never throws.
std::vector<DeviceInfo> listVulkanDevices();

}  // namespace sightline
