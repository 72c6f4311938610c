#include "core/vulkan/vulkan_context.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/error.h"

namespace sightline {
namespace {

/// What to do where memory ends. by_budget: at what the user allowed, not at what there is.
std::string advice(const VulkanMemoryUse& use, bool by_budget) {
  std::string text = by_budget ? "; give a larger --memory-budget" : "; ";
  if (use.remedy != nullptr) return text + (by_budget ? " or " : "give ") + use.remedy;
  return text + (by_budget ? ", or leave it out" : "use the device cpu or opencl, or a smaller scene");
}

double mebibytes(uint64_t bytes) {
  return double(bytes) / 1048576.0;
}

bool isForShaders(VulkanMemory memory) {
  return memory == VulkanMemory::kDevice || memory == VulkanMemory::kShared;
}

/// Families of the queue for everything that is needed and, if there is one that does nothing else, of the
/// queue for copies.
std::vector<uint32_t> chooseFamilies(const std::vector<VkQueueFlags>& queues, VkQueueFlags needed) {
  std::optional<uint32_t> all, transfer;
  for (uint32_t i = 0; i < queues.size(); ++i) {
    if ((queues[i] & needed) == needed && !all) all = i;
    const bool works = queues[i] & (VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT);
    if ((queues[i] & VK_QUEUE_TRANSFER_BIT) && !works && !transfer) transfer = i;
  }
  if (!transfer) return {all.value()};
  return {all.value(), *transfer};
}

}  // namespace

VulkanBuffer& VulkanBuffer::operator=(VulkanBuffer&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(buffer_, other.buffer_);
  std::swap(bytes_, other.bytes_);
  std::swap(address_, other.address_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

VulkanMemoryBlock& VulkanMemoryBlock::operator=(VulkanMemoryBlock&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(total_, other.total_);
  return *this;
}

VulkanMemoryBlock::~VulkanMemoryBlock() {
  if (total_) *total_ -= bytes_;
}

VulkanContext::VulkanContext(const std::string& selector, const VulkanNeeds& needs, uint64_t memory_budget)
    : api_(VulkanInstance::get().api()),
      choice_(selectVulkanDevice(selector, needs)),
      shaders_(needs.shaders),
      features_(featuresFor(choice_.abilities, needs)),
      families_(chooseFamilies(choice_.abilities.queues, needs.queue)) {
  api_.vkGetPhysicalDeviceMemoryProperties(choice_.physical, &memory_);
  readLimits();
  memory_limit_ = memory_budget > 0 ? std::min(memory_budget, info().memory_bytes) : info().memory_bytes;
  createDevice(needs);
}

VulkanContext::~VulkanContext() {
  if (!device_) return;
  api_.vkDeviceWaitIdle(device_);
  api_.vkDestroyDevice(device_, nullptr);
}

std::span<const uint32_t> VulkanContext::shader(const std::string& name) const {
  if (shaders_ == nullptr) throw Error(fmt::format("no shader {}: the context has no program", name));
  return shaders_(name);
}

void VulkanContext::createDevice(const VulkanNeeds& needs) {
  std::set<std::string, std::less<>> names(needs.extensions.begin(), needs.extensions.end());
  for (const VulkanFeature feature : features_) {
    const auto its = extensionsOf(feature);
    names.insert(its.begin(), its.end());
  }
  std::vector<const char*> extensions;
  for (const std::string& name : names) extensions.push_back(name.c_str());
  VulkanFeatureChain chain(names);
  for (const VulkanFeature feature : features_) chain.at(feature) = VK_TRUE;
  const float priority = 1;
  std::vector<VkDeviceQueueCreateInfo> queues;
  for (const uint32_t family : families_) {
    auto queue = vkStruct<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    queues.push_back(queue);
  }
  auto info = vkStruct<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &chain.first();
  info.queueCreateInfoCount = static_cast<uint32_t>(queues.size());
  info.pQueueCreateInfos = queues.data();
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  checkVk(api_.vkCreateDevice(choice_.physical, &info, nullptr, &device_), "vkCreateDevice");
  api_.loadDevice(device_, {has(VulkanFeature::kStructures), has(VulkanFeature::kPipelines),
                            has(VulkanFeature::kMeshShaders)});
  api_.vkGetDeviceQueue(device_, families_.front(), 0, &queue_);
  api_.vkGetDeviceQueue(device_, families_.back(), 0, &transfer_queue_);
}

void VulkanContext::readLimits() {
  auto pipelines = vkStruct<VkPhysicalDeviceRayTracingPipelinePropertiesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR);
  auto structures = vkStruct<VkPhysicalDeviceAccelerationStructurePropertiesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR);
  auto maintenance = vkStruct<VkPhysicalDeviceMaintenance3Properties>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES);
  auto meshes = vkStruct<VkPhysicalDeviceMeshShaderPropertiesEXT>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_PROPERTIES_EXT);
  if (has(VulkanFeature::kStructures)) maintenance.pNext = &structures;
  if (has(VulkanFeature::kMeshShaders)) meshes.pNext = std::exchange(maintenance.pNext, &meshes);
  if (has(VulkanFeature::kPipelines)) pipelines.pNext = std::exchange(maintenance.pNext, &pipelines);
  auto properties = vkStruct<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &maintenance;
  api_.vkGetPhysicalDeviceProperties2(choice_.physical, &properties);
  const VkPhysicalDeviceLimits& general = properties.properties.limits;
  limits_.allocation_bytes = maintenance.maxMemoryAllocationSize;
  limits_.part_triangles = structures.maxPrimitiveCount;
  limits_.scratch_alignment = structures.minAccelerationStructureScratchOffsetAlignment;
  limits_.launch_groups = general.maxComputeWorkGroupCount[0];
  const uint64_t width = uint64_t(general.maxComputeWorkGroupCount[0]) * general.maxComputeWorkGroupSize[0];
  limits_.launch_rays =
      static_cast<uint32_t>(std::min<uint64_t>(pipelines.maxRayDispatchInvocationCount, width));
  limits_.draws = general.maxDrawIndirectCount;
  limits_.vertex_number = general.maxDrawIndexedIndexValue;
  limits_.mesh_groups = meshes.maxMeshWorkGroupTotalCount;
  limits_.image_side =
      std::min({general.maxImageDimension2D, general.maxFramebufferWidth, general.maxFramebufferHeight});
  limits_.timestamp_ns = general.timestampPeriod;
  limits_.handle_bytes = pipelines.shaderGroupHandleSize;
  limits_.table_alignment = pipelines.shaderGroupBaseAlignment;
}

uint32_t VulkanContext::memoryType(uint32_t allowed, VulkanMemory memory) const {
  const VkMemoryPropertyFlags visible =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const VkMemoryPropertyFlags needed = memory == VulkanMemory::kDevice ? 0 : visible;
  const VkMemoryPropertyFlags welcome = memory == VulkanMemory::kDevice ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
                                        : memory == VulkanMemory::kReadback
                                            ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                            : 0;
  std::optional<uint32_t> second;
  for (uint32_t type = 0; type < memory_.memoryTypeCount; ++type) {
    const VkMemoryPropertyFlags flags = memory_.memoryTypes[type].propertyFlags;
    if (!(allowed >> type & 1) || (flags & needed) != needed) continue;
    if ((flags & welcome) == welcome) return type;
    if (!second) second = type;
  }
  if (!second) throw Error(fmt::format("{} has no suitable type of memory", choice_.info.id));
  return *second;
}

void VulkanContext::requireOneAllocation(uint64_t bytes, const VulkanMemoryUse& use) const {
  if (bytes <= limits_.allocation_bytes) return;
  throw Error(fmt::format(
      "{} ({}): the {} take {:.0f} MiB, more than the {:.0f} MiB that the driver allows one buffer{}",
      info().id, info().name, use.what, mebibytes(bytes), mebibytes(limits_.allocation_bytes),
      advice(use, false)));
}

VulkanMemoryBlock VulkanContext::allocate(uint64_t bytes, const VkMemoryRequirements& requirements,
                                          VulkanMemory memory, const VulkanMemoryUse& use) const {
  requireOneAllocation(bytes, use);
  auto flags = vkStruct<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  auto allocate = vkStruct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  const bool addressed = isForShaders(memory) && has(VulkanFeature::kAddresses);
  if (addressed) allocate.pNext = &flags;
  allocate.allocationSize = requirements.size;
  allocate.memoryTypeIndex = memoryType(requirements.memoryTypeBits, memory);
  // Drivers on the processor promise more memory than there is.
  VkDeviceMemory block = VK_NULL_HANDLE;
  const VkResult code = fits(bytes) ? api_.vkAllocateMemory(device_, &allocate, nullptr, &block)
                                    : VK_ERROR_OUT_OF_DEVICE_MEMORY;
  if (code == VK_ERROR_OUT_OF_DEVICE_MEMORY || code == VK_ERROR_OUT_OF_HOST_MEMORY) {
    const bool by_budget = *allocated_ + bytes > memory_limit_ && memory_limit_ < info().memory_bytes;
    throw Error(fmt::format(
        "{} ({}): the {} take {:.1f} MiB, but {:.1f} of the {:.1f} MiB that it may use are in use{}",
        info().id, info().name, use.what, mebibytes(bytes), mebibytes(*allocated_), mebibytes(memory_limit_),
        advice(use, by_budget)));
  }
  checkVk(code, "vkAllocateMemory");
  VulkanMemoryBlock result;
  result.memory_ = {*this, block, [](const VulkanContext& context, VkDeviceMemory freed) {
                      context.api().vkFreeMemory(context.device(), freed, nullptr);
                    }};
  result.bytes_ = bytes;
  result.total_ = allocated_;
  *allocated_ += bytes;
  return result;
}

VulkanBuffer VulkanContext::buffer(uint64_t bytes, const VulkanMemoryUse& use, VulkanMemory memory) const {
  bytes = (std::max<uint64_t>(bytes, 16) + 3) / 4 * 4;
  requireOneAllocation(bytes, use);
  auto info = vkStruct<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = bytes;
  info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (isForShaders(memory)) {
    info.usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                  VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    if (has(VulkanFeature::kAddresses)) info.usage |= VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    if (has(VulkanFeature::kStructures)) {
      info.usage |= VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR |
                    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
    }
    if (has(VulkanFeature::kPipelines)) info.usage |= VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR;
  }
  if (families_.size() > 1) {
    info.sharingMode = VK_SHARING_MODE_CONCURRENT;
    info.queueFamilyIndexCount = static_cast<uint32_t>(families_.size());
    info.pQueueFamilyIndices = families_.data();
  }
  VulkanBuffer result;
  VkBuffer handle = VK_NULL_HANDLE;
  checkVk(api_.vkCreateBuffer(device_, &info, nullptr, &handle), "vkCreateBuffer");
  result.buffer_ = {*this, handle, [](const VulkanContext& context, VkBuffer buffer) {
                      context.api().vkDestroyBuffer(context.device(), buffer, nullptr);
                    }};
  VkMemoryRequirements requirements{};
  api_.vkGetBufferMemoryRequirements(device_, handle, &requirements);
  result.memory_ = allocate(bytes, requirements, memory, use);
  checkVk(api_.vkBindBufferMemory(device_, handle, result.memory_.get(), 0), "vkBindBufferMemory");
  if (memory != VulkanMemory::kDevice) {
    checkVk(api_.vkMapMemory(device_, result.memory_.get(), 0, VK_WHOLE_SIZE, 0, &result.mapped_),
            "vkMapMemory");
  }
  if (isForShaders(memory) && has(VulkanFeature::kAddresses)) {
    auto of = vkStruct<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
    of.buffer = handle;
    result.address_ = api_.vkGetBufferDeviceAddress(device_, &of);
  }
  result.bytes_ = bytes;
  return result;
}

}  // namespace sightline
