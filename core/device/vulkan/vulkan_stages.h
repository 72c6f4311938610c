#pragma once
#include <array>
#include <optional>
#include <span>

#include "core/device/device.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_runner.h"
#include "core/device/vulkan/vulkan_scene.h"

namespace sightline {

/// The stages as Vulkan shaders (vk_shaders): the API of a GpuSampler.
class VulkanStages {
 public:
  using Buffer = VulkanBuffer;

  /// selector: as of selectVulkanDevice. `scene` is not needed afterwards. Throws Error.
  VulkanStages(const std::string& selector, const Scene& scene, const Bvh& bvh, const DeviceOptions& options);

  DeviceInfo info() const;
  bool fits(uint64_t bytes) const { return context_.fits(bytes); }
  uint64_t allocatedBytes() const { return context_.allocatedBytes(); }

  VulkanBuffer buffer(uint64_t bytes, const char* what) { return context_.buffer(bytes, what); }
  void release(VulkanBuffer& buffer);
  void write(const VulkanBuffer& buffer, const void* data, uint64_t bytes);
  void read(const VulkanBuffer& buffer, void* target, uint64_t bytes);
  void fill(const VulkanBuffer& buffer, uint32_t word, uint64_t bytes) {
    runner_.commands.fill(buffer, word, bytes);
  }
  void copy(const VulkanBuffer& from, const VulkanBuffer& to, uint64_t bytes) {
    runner_.commands.copy(from, to, bytes);
  }

  StageLaunch& launch() { return runner_.launch.numbers; }
  void bind(StageBuffer name, const VulkanBuffer& buffer) { runner_.bind(name, buffer); }
  /// The pipelines of these tracing stages and of all others, on several threads.
  void prepare(std::span<const GpuStage> stages);
  /// Makes the stage's pipeline when it is first needed.
  void run(GpuStage stage, uint64_t count);
  std::array<uint32_t, kCounterWords> takeCounters() { return runner_.takeCounters(); }

  const VulkanContext& context() const { return context_; }
  VulkanRunner& runner() { return runner_; }

 private:
  /// Threads may ask for different ones at once.
  const VulkanStage& stage(GpuStage name);

  SurfaceFeatures features_;
  VulkanContext context_;
  VulkanRunner runner_;
  uint32_t group_;  ///< work items of a group with ray queries
  VulkanScene scene_;
  std::array<std::optional<VulkanStage>, kGpuStages> stages_;
  std::optional<VulkanUpload> upload_;
  VulkanBuffer readback_;
};

}  // namespace sightline
