#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/vulkan/vulkan_devices.h"

namespace sightline {

class VulkanContext;

/// Owns a Vulkan object of a device.
template <typename Handle>
class VulkanHandle {
 public:
  using Destroy = void (*)(const VulkanContext&, Handle);
  VulkanHandle() = default;
  VulkanHandle(const VulkanContext& context, Handle handle, Destroy destroy)
      : context_(&context), handle_(handle), destroy_(destroy) {}
  VulkanHandle(VulkanHandle&& other) noexcept { *this = std::move(other); }
  VulkanHandle& operator=(VulkanHandle&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(handle_, other.handle_);
    std::swap(destroy_, other.destroy_);
    return *this;
  }
  ~VulkanHandle() {
    if (handle_ != VK_NULL_HANDLE) destroy_(*context_, handle_);
  }
  Handle get() const { return handle_; }
  const Handle* address() const { return &handle_; }

 private:
  const VulkanContext* context_ = nullptr;
  Handle handle_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
};

/// Where a buffer lies.
enum class VulkanMemory {
  kDevice,    ///< device-local: everything that shaders work on
  kUpload,    ///< host-visible, written by the host in one go
  kShared,    ///< the same, and shaders read it: for what is little and read once
  kReadback,  ///< host-visible and cached, read by the host
};

/// What memory is for ("triangles of the scene"), and what to do if there is too little of it, if that is
/// something special ("a smaller --raster-resolution").
struct VulkanMemoryUse {
  const char* what;
  const char* remedy = nullptr;
  VulkanMemoryUse(const char* its_what, const char* its_remedy = nullptr)
      : what(its_what), remedy(its_remedy) {}
};

/// Device memory that counts as allocated as long as it lives; empty by default.
class VulkanMemoryBlock {
 public:
  VulkanMemoryBlock() = default;
  VulkanMemoryBlock(VulkanMemoryBlock&& other) noexcept { *this = std::move(other); }
  VulkanMemoryBlock& operator=(VulkanMemoryBlock&& other) noexcept;
  ~VulkanMemoryBlock();
  VkDeviceMemory get() const { return memory_.get(); }

 private:
  friend class VulkanContext;
  VulkanHandle<VkDeviceMemory> memory_;
  uint64_t bytes_ = 0;
  std::shared_ptr<uint64_t> total_;  ///< of the context: bytes in all its buffers and images
};

/// Memory with its buffer; empty by default. Outlives no context.
class VulkanBuffer {
 public:
  VulkanBuffer() = default;
  VulkanBuffer(VulkanBuffer&& other) noexcept { *this = std::move(other); }
  VulkanBuffer& operator=(VulkanBuffer&& other) noexcept;
  VkBuffer get() const { return buffer_.get(); }
  uint64_t bytes() const { return bytes_; }
  /// For shaders and for the building of acceleration structures; 0 without VulkanFeature::kAddresses.
  VkDeviceAddress address() const { return address_; }
  /// Of all but kDevice; coherent.
  void* mapped() const { return mapped_; }

 private:
  friend class VulkanContext;
  VulkanMemoryBlock memory_;
  VulkanHandle<VkBuffer> buffer_;  // goes first
  uint64_t bytes_ = 0;
  VkDeviceAddress address_ = 0;
  void* mapped_ = nullptr;
};

/// What we need to know of a device's limits.
struct VulkanLimits {
  uint64_t allocation_bytes = 0;  ///< largest allocation and buffer
  uint64_t part_triangles = 0;    ///< of a bottom-level acceleration structure
  uint32_t scratch_alignment = 0;
  uint32_t launch_rays = 0;      ///< of one trace command
  uint32_t launch_groups = 0;    ///< of one dispatch
  uint32_t draws = 0;            ///< of one list
  uint32_t vertex_number = 0;    ///< largest that an index may name
  uint32_t mesh_groups = 0;      ///< of one draw of mesh shaders
  uint32_t image_side = 0;       ///< pixels of an image that can be drawn into
  uint32_t handle_bytes = 0;     ///< shader group handle
  uint32_t table_alignment = 0;  ///< of the parts of a shader binding table
  double timestamp_ns = 0;       ///< nanoseconds of a step
};

/// A device with its queues. Not thread-safe. Everything throws Error with the name of the call that failed.
class VulkanContext {
 public:
  /// selector: as of selectVulkanDevice. memory_budget: bytes that all buffers may take; 0: what the device
  /// has.
  VulkanContext(const std::string& selector, const VulkanNeeds& needs, uint64_t memory_budget = 0);
  VulkanContext(const VulkanContext&) = delete;
  VulkanContext& operator=(const VulkanContext&) = delete;
  ~VulkanContext();

  const VulkanApi& api() const { return api_; }
  VkDevice device() const { return device_; }
  const DeviceInfo& info() const { return choice_.info; }
  const VulkanLimits& limits() const { return limits_; }
  const VulkanAbilities& abilities() const { return choice_.abilities; }
  /// Whether the feature is on.
  bool has(VulkanFeature feature) const { return features_.contains(feature); }
  /// SPIR-V of a shader of the program. Throws Error where it has none of this name.
  std::span<const uint32_t> shader(const std::string& name) const;
  uint64_t allocatedBytes() const { return *allocated_; }
  /// Whether a buffer of this size is within the limits.
  bool fits(uint64_t bytes) const {
    return bytes <= limits_.allocation_bytes && *allocated_ + bytes <= memory_limit_;
  }

  VkQueue queue() const { return queue_; }
  uint32_t queueFamily() const { return families_.front(); }
  /// What queue() can do.
  VkQueueFlags queueFlags() const { return choice_.abilities.queues[families_.front()]; }
  /// Whether commands on queue() can write the time.
  bool hasTimestamps() const { return choice_.abilities.timestamp_bits[families_.front()] > 0; }
  /// A queue of a family that only copies, where there is one, else the same as queue().
  VkQueue transferQueue() const { return transfer_queue_; }
  uint32_t transferFamily() const { return families_.back(); }

  /// For a buffer or an image of `bytes` bytes. use: as of buffer().
  VulkanMemoryBlock allocate(uint64_t bytes, const VkMemoryRequirements& requirements, VulkanMemory memory,
                             const VulkanMemoryUse& use) const;
  /// use: for the message when it does not fit. 0 bytes: a small dummy.
  VulkanBuffer buffer(uint64_t bytes, const VulkanMemoryUse& use,
                      VulkanMemory memory = VulkanMemory::kDevice) const;

 private:
  void createDevice(const VulkanNeeds& needs);
  void requireOneAllocation(uint64_t bytes, const VulkanMemoryUse& use) const;
  void readLimits();
  uint32_t memoryType(uint32_t allowed, VulkanMemory memory) const;

  VulkanApi api_;
  VulkanDeviceChoice choice_;
  VulkanShaders shaders_;
  std::set<VulkanFeature> features_;
  VkPhysicalDeviceMemoryProperties memory_{};
  VulkanLimits limits_;
  uint64_t memory_limit_ = 0;       ///< bytes that all buffers may take
  std::vector<uint32_t> families_;  ///< one or two: of queue and transfer queue
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE, transfer_queue_ = VK_NULL_HANDLE;
  std::shared_ptr<uint64_t> allocated_ = std::make_shared<uint64_t>(0);
};

}  // namespace sightline
