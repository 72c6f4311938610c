#include "core/vulkan/vulkan_devices.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/trace/select_device.h"

namespace sightline {
namespace {

std::set<std::string, std::less<>> readExtensions(const VulkanApi& api, VkPhysicalDevice device) {
  uint32_t count = 0;
  checkVk(api.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr),
          "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> properties(count);
  checkVk(api.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, properties.data()),
          "vkEnumerateDeviceExtensionProperties");
  std::set<std::string, std::less<>> names;
  for (const VkExtensionProperties& property : properties) names.insert(property.extensionName);
  return names;
}

VulkanAbilities abilitiesOf(const VulkanApi& api, VkPhysicalDevice device,
                            const VkPhysicalDeviceProperties& properties) {
  VulkanAbilities abilities;
  abilities.version = properties.apiVersion;
  if (abilities.version < VK_API_VERSION_1_2) return abilities;
  const VkPhysicalDeviceLimits& limits = properties.limits;
  abilities.sub_pixel_bits = limits.subPixelPrecisionBits;
  abilities.group_size = std::min(limits.maxComputeWorkGroupInvocations, limits.maxComputeWorkGroupSize[0]);
  abilities.extensions = readExtensions(api, device);
  VulkanFeatureChain chain(abilities.extensions);
  api.vkGetPhysicalDeviceFeatures2(device, &chain.first());
  for (uint32_t i = 0; i < kVulkanFeatures; ++i) {
    const auto feature = VulkanFeature(i);
    if (chain.at(feature)) abilities.features.insert(feature);
  }
  uint32_t count = 0;
  api.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  api.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (const VkQueueFamilyProperties& family : families) {
    abilities.queues.push_back(family.queueFlags);
    abilities.timestamp_bits.push_back(family.timestampValidBits);
  }
  return abilities;
}

VulkanDeviceChoice describe(const VulkanApi& api, VkPhysicalDevice physical, size_t index,
                            const VulkanNeeds& needs) {
  VulkanDeviceChoice device;
  device.physical = physical;
  device.info.id = fmt::format("vulkan:{}", index);
  auto driver =
      vkStruct<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  auto properties = vkStruct<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &driver;
  api.vkGetPhysicalDeviceProperties2(physical, &properties);
  const uint32_t version = properties.properties.apiVersion;
  device.type = properties.properties.deviceType;
  device.info.on_cpu = device.type == VK_PHYSICAL_DEVICE_TYPE_CPU;
  device.info.name = properties.properties.deviceName;
  device.info.driver =
      fmt::format("Vulkan {}.{}.{}, {} {}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                  VK_API_VERSION_PATCH(version), driver.driverName, driver.driverInfo);
  VkPhysicalDeviceMemoryProperties memory{};
  api.vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  for (uint32_t heap = 0; heap < memory.memoryHeapCount; ++heap) {
    if (memory.memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) {
      device.info.memory_bytes += memory.memoryHeaps[heap].size;
    }
  }
  try {
    device.abilities = abilitiesOf(api, physical, properties.properties);
    device.info.unusable = whyUnusable(device.abilities, needs);
  } catch (const Error& error) {
    device.info.unusable = error.what();
  }
  return device;
}

int rank(const VulkanDeviceChoice& device) {
  switch (device.type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    default:
      return 3;
  }
}

}  // namespace

std::vector<VulkanDeviceChoice> findVulkanDevices(const VulkanNeeds& needs) {
  const VulkanInstance& instance = VulkanInstance::get();
  const VulkanApi& api = instance.api();
  uint32_t count = 0;
  checkVk(api.vkEnumeratePhysicalDevices(instance.handle(), &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  checkVk(api.vkEnumeratePhysicalDevices(instance.handle(), &count, handles.data()),
          "vkEnumeratePhysicalDevices");
  std::vector<VulkanDeviceChoice> devices;
  for (VkPhysicalDevice handle : handles) devices.push_back(describe(api, handle, devices.size(), needs));
  return devices;
}

VulkanDeviceChoice selectVulkanDevice(const std::string& selector, const VulkanNeeds& needs) {
  return selectDevice(selector, "vulkan", findVulkanDevices(needs), rank, needs.none);
}

}  // namespace sightline
