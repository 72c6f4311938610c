#include "core/device/vulkan_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

#include "core/error.h"

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
  auto core =
      vkStruct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
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

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

const VulkanDeviceChoice* match(const std::vector<VulkanDeviceChoice>& devices, const std::string& wanted) {
  if (wanted.empty()) {
    const VulkanDeviceChoice* best = nullptr;
    for (const VulkanDeviceChoice& device : devices) {
      if (device.info.unusable.empty() && (!best || rank(device) < rank(*best))) best = &device;
    }
    return best;
  }
  size_t index = 0;
  const auto [end, failure] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (failure == std::errc() && end == wanted.data() + wanted.size()) {
    return index < devices.size() ? &devices[index] : nullptr;
  }
  const auto found = std::find_if(devices.begin(), devices.end(), [&](const VulkanDeviceChoice& device) {
    return lowerCase(device.info.name).find(lowerCase(wanted)) != std::string::npos;
  });
  return found == devices.end() ? nullptr : &*found;
}

/// What there is, for the end of an error message.
std::string inventory(const std::vector<VulkanDeviceChoice>& devices) {
  if (devices.empty()) {
    return "no Vulkan device found: install a driver with ray tracing, or use the devices cpu or opencl";
  }
  std::string text = "there is";
  for (const VulkanDeviceChoice& device : devices) {
    text += fmt::format("{} {} ({}{}{})", &device == &devices.front() ? "" : ",", device.info.id,
                        device.info.name,
                        device.info.unusable.empty() ? "" : "; unusable: ", device.info.unusable);
  }
  return text;
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

std::vector<VulkanDeviceChoice> findVulkanDevices(const VulkanInstance& instance) {
  const VulkanApi& api = instance.api();
  uint32_t count = 0;
  checkVk(api.vkEnumeratePhysicalDevices(instance.get(), &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> handles(count);
  checkVk(api.vkEnumeratePhysicalDevices(instance.get(), &count, handles.data()),
          "vkEnumeratePhysicalDevices");
  std::vector<VulkanDeviceChoice> devices;
  for (VkPhysicalDevice handle : handles) devices.push_back(describe(api, handle, devices.size()));
  return devices;
}

VulkanDeviceChoice selectVulkanDevice(const VulkanInstance& instance, const std::string& selector) {
  const std::string prefix = "vulkan";
  const bool named = selector.size() > prefix.size() + 1 && selector[prefix.size()] == ':';
  if (!selector.starts_with(prefix) || (selector != prefix && !named)) {
    throw Error(fmt::format("device \"{}\": expected vulkan, vulkan:INDEX or vulkan:PART-OF-NAME", selector),
                kExitUsage);
  }
  const std::vector<VulkanDeviceChoice> devices = findVulkanDevices(instance);
  const VulkanDeviceChoice* device = match(devices, named ? selector.substr(prefix.size() + 1) : "");
  if (!device) throw Error(fmt::format("device \"{}\": {}", selector, inventory(devices)));
  if (!device->info.unusable.empty()) {
    throw Error(fmt::format("device \"{}\" ({}) cannot be used: {}", selector, device->info.name,
                            device->info.unusable));
  }
  return *device;
}

std::vector<DeviceInfo> listVulkanDevices() {
  std::vector<DeviceInfo> list;
  try {
    const VulkanInstance instance;
    for (VulkanDeviceChoice& device : findVulkanDevices(instance)) list.push_back(std::move(device.info));
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
