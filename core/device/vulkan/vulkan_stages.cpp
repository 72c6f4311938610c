#include "core/device/vulkan/vulkan_stages.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/device/vulkan/tracing_needs.h"
#include "core/trace/parallel_copy.h"

namespace sightline {
namespace {

/// Read back at once. The buffer is kept, as those of uploads are: the H200's driver takes 4 ms to make 16
/// MiB.
constexpr uint64_t kReadbackBytes = 64u << 20;
/// Written by one command, and as many bytes as so many commands take: beyond, an upload is faster.
constexpr uint64_t kUpdateBytes = 65536, kMostUpdateBytes = 8 * kUpdateBytes;
/// Work items of a group with ray queries, if the options name no other.
constexpr uint32_t kGroup = 64;

}  // namespace

VulkanStages::VulkanStages(const std::string& selector, const Scene& scene, const Bvh& bvh,
                           const DeviceOptions& options)
    : features_(featuresOf(scene.surfaces)),
      context_(selector, tracingNeeds(options.ray_queries), options.memory_budget_bytes),
      runner_(context_),
      group_(options.work_group_size > 0 ? options.work_group_size : kGroup),
      scene_(uploadVulkanScene(context_, scene, bvh, options.part_triangles)) {
  scene_.describe(runner_);
  for (uint32_t i = 0; i < kGpuStages; ++i) {
    if (!tracesRays(GpuStage(i))) stages_[i] = VulkanStage::list(context_, shaderName(GpuStage(i)));
  }
}

DeviceInfo VulkanStages::info() const {
  DeviceInfo info = context_.info();
  info.layout = vulkanLayout(usesPipelines(context_));
  info.driver_tree_parts = static_cast<uint32_t>(scene_.tree.parts.size());
  info.driver_tree_bytes = scene_.tree.bytes;
  info.driver_tree_build_seconds = scene_.tree.build_seconds;
  return info;
}

void VulkanStages::release(VulkanBuffer& buffer) {
  if (buffer.get() == VK_NULL_HANDLE) return;
  runner_.commands.finish();
  buffer = VulkanBuffer();
}

void VulkanStages::write(const VulkanBuffer& buffer, const void* data, uint64_t bytes) {
  if (bytes > kMostUpdateBytes) {
    runner_.commands.finish();
    if (!upload_) upload_.emplace(context_);
    upload_->write(buffer, data, bytes);
    return upload_->finish();
  }
  for (uint64_t first = 0; first < bytes; first += kUpdateBytes) {
    runner_.commands.update(buffer, static_cast<const char*>(data) + first,
                            std::min(kUpdateBytes, bytes - first), first);
  }
}

void VulkanStages::read(const VulkanBuffer& buffer, void* target, uint64_t bytes) {
  if (readback_.bytes() < std::min(bytes, kReadbackBytes)) {
    readback_ = VulkanBuffer();
    readback_ = context_.buffer(std::min(bytes, kReadbackBytes), "staging memory", VulkanMemory::kReadback);
  }
  for (uint64_t first = 0; first < bytes; first += kReadbackBytes) {
    const uint64_t count = std::min(bytes - first, kReadbackBytes);
    runner_.commands.copy(buffer, readback_, count, first);
    runner_.commands.finish();
    parallelCopy(static_cast<char*>(target) + first, readback_.mapped(), count);
  }
}

void VulkanStages::prepare(std::span<const GpuStage> stages) {
  std::vector<GpuStage> all(stages.begin(), stages.end());
  for (uint32_t i = 0; i < kGpuStages; ++i) {
    if (!tracesRays(GpuStage(i))) all.push_back(GpuStage(i));
  }
  tbb::parallel_for(size_t(0), all.size(), [&](size_t i) { stage(all[i]).compile(); });
}

void VulkanStages::run(GpuStage name, uint64_t count) {
  runner_.run(stage(name), static_cast<uint32_t>(count));
}

const VulkanStage& VulkanStages::stage(GpuStage name) {
  std::optional<VulkanStage>& made = stages_[uint32_t(name)];
  if (!made) made = tracingStage(context_, shaderName(name), group_, features_);
  return *made;
}

}  // namespace sightline
