#pragma once
#include <algorithm>

#include "core/vulkan/vulkan_context.h"
#include "core/vulkan/vulkan_stage.h"

namespace sightline {

/// Records commands and runs them. Every command waits for those before it, but for updateBeside. What they
/// use must live as long as they run; when they go they wait for what was submitted, so after an error too it
/// is enough that buffers are declared before them.
class VulkanCommands {
 public:
  VulkanCommands(const VulkanContext& context, VkQueue queue, uint32_t family);
  VulkanCommands(const VulkanCommands&) = delete;
  VulkanCommands& operator=(const VulkanCommands&) = delete;
  ~VulkanCommands();

  void fill(const VulkanBuffer& buffer, uint32_t value, uint64_t bytes, uint64_t offset = 0);
  /// At most 65,536 bytes, a multiple of 4.
  void update(const VulkanBuffer& buffer, const void* data, uint64_t bytes, uint64_t offset = 0);
  /// The same without a barrier before it: the command recorded last must not use these bytes.
  void updateBeside(const VulkanBuffer& buffer, const void* data, uint64_t bytes, uint64_t offset);
  void copy(const VulkanBuffer& from, const VulkanBuffer& to, uint64_t bytes, uint64_t from_offset = 0,
            uint64_t to_offset = 0);
  /// launch: of VulkanPush.
  void run(const VulkanStage& stage, VkDeviceAddress launch, uint32_t count);
  /// For other commands: the buffer in recording, after a barrier.
  VkCommandBuffer next();

  /// Runs what was recorded.
  void submit();
  /// Waits for what was submitted.
  void wait();
  /// Runs what was recorded and waits: then the host sees all that was written.
  void finish();

 private:
  void barrier(VkPipelineStageFlags to, VkAccessFlags access);

  const VulkanContext& context_;
  VkQueue queue_;
  VulkanHandle<VkCommandPool> pool_;
  VulkanHandle<VkFence> fence_;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  bool recording_ = false, submitted_ = false;
};

/// Copies to device-local buffers through a pair of staging buffers, on the queue for copies: the host fills
/// one while the other travels.
class VulkanUpload {
 public:
  explicit VulkanUpload(const VulkanContext& context);
  /// Writes `bytes` bytes at `offset`; fill(piece, first_byte, count) puts `count` bytes from `first_byte` of
  /// the whole into the piece. `unit`: pieces are multiples of it, bytes.
  template <typename Fill>
  void write(const VulkanBuffer& target, uint64_t bytes, uint64_t unit, Fill&& fill) {
    const uint64_t piece = kStagingBytes / unit * unit;
    for (uint64_t first = 0; first < bytes; first += piece) {
      const uint64_t count = std::min(piece, bytes - first);
      Half& half = halves_[turn_ ^= 1];
      half.commands.wait();
      fill(half.staging.mapped(), first, count);
      half.commands.copy(half.staging, target, count, 0, first);
      half.commands.submit();
    }
  }
  void write(const VulkanBuffer& target, const void* data, uint64_t bytes);
  /// Waits until everything has arrived.
  void finish();

 private:
  static constexpr uint64_t kStagingBytes = 16u << 20;
  struct Half {
    VulkanBuffer staging;
    VulkanCommands commands;  // goes, and waits, first
  };
  Half halves_[2];
  int turn_ = 0;
};

}  // namespace sightline
