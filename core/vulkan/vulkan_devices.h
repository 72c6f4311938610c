#pragma once
#include <string>
#include <vector>

#include "core/trace/device_info.h"
#include "core/vulkan/vulkan_instance.h"
#include "core/vulkan/vulkan_needs.h"

namespace sightline {

/// A physical device.
struct VulkanDeviceChoice {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  VulkanAbilities abilities;
  DeviceInfo info;
};

/// Every physical device of the process's instance, in the order of its index in "vulkan:INDEX"; those that
/// do not do for the needs with the reason. Throws Error as VulkanInstance::get does.
std::vector<VulkanDeviceChoice> findVulkanDevices(const VulkanNeeds& needs);

/// selector: "vulkan" (a discrete GPU if there is a usable one, else an integrated one, else whatever),
/// "vulkan:INDEX" or "vulkan:PART-OF-NAME" (any case, the first that matches). Throws Error that lists what
/// there is, or says what the device lacks.
VulkanDeviceChoice selectVulkanDevice(const std::string& selector, const VulkanNeeds& needs);

}  // namespace sightline
