#pragma once
#include <memory>

#include "core/device/vulkan_api.h"

namespace sightline {

/// A Vulkan instance without any window system.
///
/// With the environment variable SIGHTLINE_VULKAN_VALIDATION=1 it runs under the Khronos validation layer,
/// synchronisation validation included, and the first message ends the process (SIGABRT) right at the call
/// that caused it: for tests.
class VulkanInstance {
 public:
  /// Throws Error where there is no loader or no driver, or the wanted layer is missing.
  VulkanInstance();
  VulkanInstance(const VulkanInstance&) = delete;
  VulkanInstance& operator=(const VulkanInstance&) = delete;
  ~VulkanInstance();

  const VulkanApi& api() const { return api_; }
  VkInstance get() const { return instance_; }

 private:
  VulkanApi api_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace sightline
