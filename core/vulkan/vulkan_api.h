#pragma once
#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

namespace sightline {

// Functions of the loader, of an instance and of a device that we use.
#define SL_VULKAN_LOADER_FUNCTIONS(X) \
  X(vkEnumerateInstanceVersion)       \
  X(vkEnumerateInstanceLayerProperties) X(vkEnumerateInstanceExtensionProperties) X(vkCreateInstance)
#define SL_VULKAN_INSTANCE_FUNCTIONS(X)       \
  X(vkEnumeratePhysicalDevices)               \
  X(vkGetPhysicalDeviceProperties2)           \
  X(vkGetPhysicalDeviceFeatures2)             \
  X(vkGetPhysicalDeviceMemoryProperties)      \
  X(vkGetPhysicalDeviceQueueFamilyProperties) \
  X(vkEnumerateDeviceExtensionProperties) X(vkCreateDevice) X(vkGetDeviceProcAddr)
#define SL_VULKAN_DEVICE_FUNCTIONS(X) \
  X(vkDestroyDevice)                  \
  X(vkGetDeviceQueue)                 \
  X(vkDeviceWaitIdle)                 \
  X(vkQueueSubmit)                    \
  X(vkCreateFence)                    \
  X(vkCreateSemaphore)                \
  X(vkDestroySemaphore)               \
  X(vkDestroyFence)                   \
  X(vkResetFences)                    \
  X(vkWaitForFences)                  \
  X(vkCreateCommandPool)              \
  X(vkDestroyCommandPool)             \
  X(vkResetCommandPool)               \
  X(vkAllocateCommandBuffers)         \
  X(vkBeginCommandBuffer)             \
  X(vkEndCommandBuffer)               \
  X(vkCreateBuffer)                   \
  X(vkDestroyBuffer)                  \
  X(vkGetBufferMemoryRequirements)    \
  X(vkAllocateMemory)                 \
  X(vkFreeMemory)                     \
  X(vkBindBufferMemory)               \
  X(vkMapMemory)                      \
  X(vkGetBufferDeviceAddress)         \
  X(vkCreateShaderModule)             \
  X(vkDestroyShaderModule)            \
  X(vkCreatePipelineLayout)           \
  X(vkDestroyPipelineLayout)          \
  X(vkCreateComputePipelines)         \
  X(vkDestroyPipeline)                \
  X(vkCreateQueryPool)                \
  X(vkDestroyQueryPool)               \
  X(vkGetQueryPoolResults)            \
  X(vkCmdResetQueryPool)              \
  X(vkResetQueryPool)                 \
  X(vkCmdBeginQuery)                  \
  X(vkCmdEndQuery)                    \
  X(vkCmdWriteTimestamp)              \
  X(vkGetFenceStatus)                 \
  X(vkCmdPipelineBarrier)             \
  X(vkCmdFillBuffer)                  \
  X(vkCmdUpdateBuffer)                \
  X(vkCmdCopyBuffer)                  \
  X(vkCmdPushConstants)               \
  X(vkCmdBindPipeline)                \
  X(vkCmdDispatch)                    \
  X(vkCreateImage)                    \
  X(vkDestroyImage)                   \
  X(vkGetImageMemoryRequirements)     \
  X(vkBindImageMemory)                \
  X(vkCreateImageView)                \
  X(vkDestroyImageView)               \
  X(vkCreateRenderPass)               \
  X(vkDestroyRenderPass)              \
  X(vkCreateFramebuffer)              \
  X(vkDestroyFramebuffer)             \
  X(vkCreateGraphicsPipelines)        \
  X(vkCmdBeginRenderPass)             \
  X(vkCmdEndRenderPass)               \
  X(vkCmdNextSubpass)                 \
  X(vkCmdSetViewport)                 \
  X(vkCmdSetScissor)                  \
  X(vkCmdDraw)                        \
  X(vkCmdDrawIndexed)                 \
  X(vkCmdDrawIndirect)                \
  X(vkCmdDrawIndirectCount)           \
  X(vkCmdDrawIndexedIndirectCount)    \
  X(vkCmdBindIndexBuffer)             \
  X(vkCmdCopyImageToBuffer)
// Only with VK_KHR_acceleration_structure.
#define SL_VULKAN_STRUCTURE_FUNCTIONS(X)        \
  X(vkCreateAccelerationStructureKHR)           \
  X(vkDestroyAccelerationStructureKHR)          \
  X(vkGetAccelerationStructureBuildSizesKHR)    \
  X(vkGetAccelerationStructureDeviceAddressKHR) \
  X(vkCmdBuildAccelerationStructuresKHR)        \
  X(vkCmdWriteAccelerationStructuresPropertiesKHR) X(vkCmdCopyAccelerationStructureKHR)
// Only with VK_KHR_ray_tracing_pipeline.
#define SL_VULKAN_PIPELINE_FUNCTIONS(X) \
  X(vkCreateRayTracingPipelinesKHR)     \
  X(vkGetRayTracingShaderGroupHandlesKHR) X(vkCmdTraceRaysKHR)
// Only with VK_EXT_mesh_shader.
#define SL_VULKAN_MESH_FUNCTIONS(X) X(vkCmdDrawMeshTasksIndirectEXT)

/// The functions, by their names. The loader library (libvulkan.so.1) is opened at run time, so that the
/// program starts where there is none.
struct VulkanApi {
  PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr = nullptr;
#define SL_MEMBER(name) PFN_##name name = nullptr;
  SL_VULKAN_LOADER_FUNCTIONS(SL_MEMBER)
  SL_VULKAN_INSTANCE_FUNCTIONS(SL_MEMBER)
  SL_VULKAN_DEVICE_FUNCTIONS(SL_MEMBER)
  SL_VULKAN_STRUCTURE_FUNCTIONS(SL_MEMBER)
  SL_VULKAN_PIPELINE_FUNCTIONS(SL_MEMBER)
  SL_VULKAN_MESH_FUNCTIONS(SL_MEMBER)
#undef SL_MEMBER

  /// Opens the loader. Throws Error where there is none.
  void loadLoader();
  /// What a device is made with besides what all have.
  struct Parts {
    bool structures = false, pipelines = false, meshes = false;
  };
  /// Throw Error that names the first function that is missing.
  void loadInstance(VkInstance instance);
  void loadDevice(VkDevice device, const Parts& parts);
};

/// Throws Error that names the call and the code, if it is not VK_SUCCESS.
void checkVk(VkResult result, const char* call);

/// An empty struct of Vulkan's of its type.
template <typename Struct>
Struct vkStruct(VkStructureType type) {
  Struct result{};
  result.sType = type;
  return result;
}

}  // namespace sightline
