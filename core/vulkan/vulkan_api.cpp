#include "core/vulkan/vulkan_api.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>

#include "core/base/error.h"

namespace sightline {
namespace {

/// What users meet, in words.
std::string describeResult(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "the driver could not start";
    case VK_ERROR_DEVICE_LOST:
      return "the driver lost the device (a fault, or a launch that took too long); run again, or use the "
             "device cpu";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "a layer is missing";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "an extension is missing";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "a feature is missing";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no driver supports this version of Vulkan";
    case VK_TIMEOUT:
      return "it took too long";
    default:
      return "Vulkan error";
  }
}

template <typename Function>
void require(Function& function, PFN_vkVoidFunction address, const char* name) {
  if (!address) throw Error(fmt::format("the Vulkan driver lacks the function {}", name));
  function = reinterpret_cast<Function>(address);
}

}  // namespace

void checkVk(VkResult result, const char* call) {
  if (result != VK_SUCCESS) {
    throw Error(fmt::format("{} failed: {} ({})", call, describeResult(result), static_cast<int>(result)));
  }
}

void VulkanApi::loadLoader() {
  // Never closed: drivers may leave threads and exit handlers behind.
  void* library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    throw Error("no Vulkan loader (libvulkan.so.1): install libvulkan1 and a driver, or use the device cpu");
  }
  vkGetInstanceProcAddr =
      reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
  if (!vkGetInstanceProcAddr)
    throw Error("libvulkan.so.1 has no vkGetInstanceProcAddr: reinstall libvulkan1");
#define SL_LOAD(name) require(name, vkGetInstanceProcAddr(nullptr, #name), #name);
  SL_VULKAN_LOADER_FUNCTIONS(SL_LOAD)
#undef SL_LOAD
}

void VulkanApi::loadInstance(VkInstance instance) {
#define SL_LOAD(name) require(name, vkGetInstanceProcAddr(instance, #name), #name);
  SL_VULKAN_INSTANCE_FUNCTIONS(SL_LOAD)
#undef SL_LOAD
}

void VulkanApi::loadDevice(VkDevice device, const Parts& parts) {
#define SL_LOAD(name) require(name, vkGetDeviceProcAddr(device, #name), #name);
  SL_VULKAN_DEVICE_FUNCTIONS(SL_LOAD)
  if (parts.structures) {
    SL_VULKAN_STRUCTURE_FUNCTIONS(SL_LOAD)
  }
  if (parts.pipelines) {
    SL_VULKAN_PIPELINE_FUNCTIONS(SL_LOAD)
  }
  if (parts.meshes) {
    SL_VULKAN_MESH_FUNCTIONS(SL_LOAD)
  }
#undef SL_LOAD
}

}  // namespace sightline
