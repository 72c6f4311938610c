#include "core/vulkan/vulkan_devices.h"

#include <fmt/format.h>

#include <utility>

#include "core/base/error.h"
#include "core/trace/select_device.h"

namespace sightline {
namespace {

std::set<std::string, std::less<>> extensionsOf(const VulkanApi& api, VkPhysicalDevice device) {
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

VulkanAbilities abilitiesOf(const VulkanApi& api, VkPhysicalDevice device, uint32_t version) {
  VulkanAbilities abilities;
  abilities.version = version;
  if (version < VK_API_VERSION_1_2) return abilities;
  abilities.extensions = extensionsOf(api, device);
  auto queries =
      vkStruct<VkPhysicalDeviceRayQueryFeaturesKHR>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR);
  auto pipelines = vkStruct<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR);
  auto structures = vkStruct<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR);
  auto views =
      vkStruct<VkPhysicalDeviceVulkan11Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES);
  auto core =
      vkStruct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  core.pNext = &views;
  auto features = vkStruct<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  // Only structs of extensions that are there may be asked for.
  const auto ask = [&](auto& extension, const char* name) {
    if (abilities.extensions.contains(name)) extension.pNext = std::exchange(core.pNext, &extension);
  };
  ask(queries, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  ask(pipelines, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
  ask(structures, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
  features.pNext = &core;
  api.vkGetPhysicalDeviceFeatures2(device, &features);
  abilities.structures = structures.accelerationStructure;
  abilities.pipelines = pipelines.rayTracingPipeline;
  abilities.ray_queries = queries.rayQuery;
  abilities.addresses = core.bufferDeviceAddress;
  abilities.scalar_layout = core.scalarBlockLayout;
  abilities.int64 = features.features.shaderInt64;
  abilities.float64 = features.features.shaderFloat64;
  abilities.multiview = views.multiview;
  abilities.multi_draw = features.features.multiDrawIndirect;
  abilities.clip_distances = features.features.shaderClipDistance;
  return abilities;
}

VulkanDeviceChoice describe(const VulkanApi& api, VkPhysicalDevice physical, size_t index) {
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
    device.abilities = abilitiesOf(api, physical, version);
    device.info.unusable = whyUnusable(device.abilities);
  } catch (const Error& error) {
    device.info.unusable = error.what();
  }
  device.info.layout = vulkanLayout(device.abilities.pipelines);
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

std::string whyUnusable(const VulkanAbilities& abilities) {
  if (abilities.version < VK_API_VERSION_1_2) {
    return fmt::format("its driver knows Vulkan {}.{}, 1.2 is needed",
                       VK_API_VERSION_MAJOR(abilities.version), VK_API_VERSION_MINOR(abilities.version));
  }
  for (const char* name :
       {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME}) {
    if (!abilities.extensions.contains(name)) return fmt::format("no ray tracing: its driver lacks {}", name);
  }
  if (!abilities.structures) return "no ray tracing: its driver has accelerationStructure off";
  if (!abilities.pipelines && !abilities.ray_queries) {
    return "no ray tracing: its driver has neither VK_KHR_ray_tracing_pipeline nor VK_KHR_ray_query";
  }
  if (!abilities.addresses) return "no addresses of buffers in shaders (bufferDeviceAddress)";
  if (!abilities.scalar_layout) return "no scalar layout of buffers (scalarBlockLayout)";
  if (!abilities.int64) return "no 64-bit integers in shaders (shaderInt64)";
  if (!abilities.float64) return "no 64-bit floats in shaders (shaderFloat64)";
  return {};
}

std::string vulkanLayout(bool pipelines) {
  return pipelines ? "driver's own tree, ray tracing pipelines" : "driver's own tree, ray queries";
}

std::vector<VulkanDeviceChoice> findVulkanDevices() {
  const VulkanInstance& instance = VulkanInstance::get();
  const VulkanApi& api = instance.api();
  uint32_t count = 0;
  checkVk(api.vkEnumeratePhysicalDevices(instance.handle(), &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  checkVk(api.vkEnumeratePhysicalDevices(instance.handle(), &count, handles.data()),
          "vkEnumeratePhysicalDevices");
  std::vector<VulkanDeviceChoice> devices;
  for (VkPhysicalDevice handle : handles) devices.push_back(describe(api, handle, devices.size()));
  return devices;
}

VulkanDeviceChoice selectVulkanDevice(const std::string& selector) {
  return selectDevice(
      selector, "vulkan", findVulkanDevices(), rank,
      "no Vulkan device found: install a driver with ray tracing, or use the devices cpu or opencl");
}

std::vector<DeviceInfo> listVulkanDevices() {
  std::vector<DeviceInfo> list;
  try {
    for (VulkanDeviceChoice& device : findVulkanDevices()) list.push_back(std::move(device.info));
  } catch (const Error& error) {
    DeviceInfo none;
    none.id = "vulkan";
    none.name = "none found";
    none.unusable = error.what();
    list.push_back(none);
  }
  return list;
}

}  // namespace sightline
