#include "core/vulkan/vulkan_instance.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace sightline {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

bool wantsValidation() {
  const char* value = std::getenv("SIGHTLINE_VULKAN_VALIDATION");
  return value && std::strcmp(value, "0") != 0 && *value != '\0';
}

bool hasLayer(const VulkanApi& api, std::string_view name) {
  uint32_t count = 0;
  checkVk(api.vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  checkVk(api.vkEnumerateInstanceLayerProperties(&count, layers.data()),
          "vkEnumerateInstanceLayerProperties");
  for (const VkLayerProperties& layer : layers) {
    if (name == layer.layerName) return true;
  }
  return false;
}

/// Any message is an error, and the call stack of the first is worth more than those that follow.
VKAPI_ATTR VkBool32 VKAPI_CALL stopAtMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                             VkDebugUtilsMessageTypeFlagsEXT,
                                             const VkDebugUtilsMessengerCallbackDataEXT* message, void*) {
  std::fprintf(stderr, "Vulkan validation: %s\n", message->pMessage);
  std::abort();
}

}  // namespace

VulkanInstance::VulkanInstance() {
  api_.loadLoader();
  uint32_t version = 0;
  checkVk(api_.vkEnumerateInstanceVersion(&version), "vkEnumerateInstanceVersion");
  if (version < VK_API_VERSION_1_2)
    throw Error("the Vulkan loader is too old: 1.2 is needed, update libvulkan1");

  auto application = vkStruct<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "sightline";
  application.apiVersion = VK_API_VERSION_1_2;
  auto info = vkStruct<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;

  // Chained to the instance's creation it covers that and the destruction; as an object, what is between.
  auto messenger =
      vkStruct<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = stopAtMessage;
  const VkValidationFeatureEnableEXT enabled[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  auto features = vkStruct<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;
  features.pNext = &messenger;
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const bool validation = wantsValidation();
  if (validation) {
    if (!hasLayer(api_, kValidationLayer)) {
      throw Error(
          "SIGHTLINE_VULKAN_VALIDATION is set, but there is no VK_LAYER_KHRONOS_validation: install "
          "vulkan-validationlayers");
    }
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
    info.pNext = &features;
  }
  const VkResult created = api_.vkCreateInstance(&info, nullptr, &instance_);
  if (created == VK_ERROR_INCOMPATIBLE_DRIVER) {
    throw Error("no Vulkan driver: install a GPU's, or mesa-vulkan-drivers 25 or later for the processor");
  }
  checkVk(created, "vkCreateInstance");
  api_.loadInstance(instance_);
  if (validation) {
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        api_.vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    if (!create) throw Error("the Vulkan loader has no vkCreateDebugUtilsMessengerEXT: update libvulkan1");
    checkVk(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
  }
}

const VulkanInstance& VulkanInstance::get() {
  static const VulkanInstance& instance = *new VulkanInstance;
  return instance;
}

}  // namespace sightline
