#pragma once
#include "core/vulkan/vulkan_api.h"

namespace sightline {

/// The process's Vulkan instance, without any window system.
///
/// There is one, made by the first use and never destroyed: drivers may leave threads and exit handlers
/// behind, and NVIDIA's (580) is not found any more once about ten instances have come and gone.
///
/// With the environment variable SIGHTLINE_VULKAN_VALIDATION=1 it runs under the Khronos validation layer,
/// synchronisation validation included, and the first message ends the process (SIGABRT) right at the call
/// that caused it: for tests.
class VulkanInstance {
 public:
  /// Throws Error where there is no loader or no driver, or the wanted layer is missing; the next call tries
  /// again. Thread-safe.
  static const VulkanInstance& get();
  VulkanInstance(const VulkanInstance&) = delete;
  VulkanInstance& operator=(const VulkanInstance&) = delete;

  const VulkanApi& api() const { return api_; }
  VkInstance handle() const { return instance_; }

 private:
  VulkanInstance();

  VulkanApi api_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace sightline
