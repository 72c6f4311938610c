#include "core/device/opencl/opencl_stages.h"

#include <algorithm>
#include <span>
#include <string_view>

namespace sightline {
namespace {

/// From so many bytes on a read goes through pinned memory.
constexpr uint64_t kFastReadBytes = 1u << 20;

/// Which buffers a kernel takes after its launch: its parameters bear their names.
std::vector<StageBuffer> buffersOf(const ClKernel& kernel) {
#define SL_BUFFER_TEXT(type, name) #name,
  constexpr std::string_view kNames[] = {SL_STAGE_BUFFERS(SL_BUFFER_TEXT)};
#undef SL_BUFFER_TEXT
  std::vector<StageBuffer> buffers;
  for (const std::string& name : argumentNames(kernel)) {
    const auto place = std::find(std::begin(kNames), std::end(kNames), name);
    if (place != std::end(kNames)) buffers.push_back(StageBuffer(place - kNames));
  }
  return buffers;
}

}  // namespace

OpenClStages::OpenClStages(const std::string& selector, const Scene& scene, const Bvh& bvh,
                           const DeviceOptions& options)
    : context_(selector), lanes_(options.rays_per_item > 0 ? options.rays_per_item : raysPerItem(context_)) {
  if (options.memory_budget_bytes > 0) context_.limitMemory(options.memory_budget_bytes);
  buildKernels(context_, lanes_, featuresOf(scene.surfaces), kernelOptionsFor(bvh));
  // Groups of 64 rays keep the cores of a CPU evenly busy and fill the smallest unit of a GPU.
  local_ = options.work_group_size > 0 ? options.work_group_size : std::max(1u, 64 / lanes_);
  for (uint32_t i = 0; i < kGpuStages; ++i) {
    kernels_[i] = context_.kernel(kernelName(GpuStage(i)));
    buffers_of_[i] = buffersOf(kernels_[i]);
  }
  scene_ = uploadScene(context_, scene, bvh, lanes_);
  dummy_ = context_.buffer(0, "dummy");
  for (uint32_t i = 0; i < kStageBuffers; ++i) bind(StageBuffer(i), dummy_);

  std::vector<uint32_t> record_of(scene.triangles.size(), 0);
  for (size_t i = bvh.references.size(); i-- > 0;) record_of[bvh.references[i]] = static_cast<uint32_t>(i);
  record_of_ = context_.buffer(record_of.size() * 4, "index of triangles");
  context_.write(record_of_, record_of.data(), record_of.size() * 4);
  bind(StageBuffer::place_of, record_of_);
  counters_ = context_.buffer(kCounterWords * 4, "counters");
  context_.fill(counters_, 0, kCounterWords * 4);
  bind(StageBuffer::counters, counters_);
}

void OpenClStages::release(ClBuffer& buffer) {
  if (buffer.get() == nullptr) return;
  for (uint32_t i = 0; i < kStageBuffers; ++i) {
    if (bound_[i].get() == buffer.get()) bind(StageBuffer(i), dummy_);
  }
  context_.finish();
  buffer = ClBuffer();
}

void OpenClStages::read(const ClBuffer& buffer, void* target, uint64_t bytes) {
  if (bytes < kFastReadBytes) return context_.read(buffer, target, bytes);
  context_.readFast(buffer, target, bytes);
}

void OpenClStages::bind(StageBuffer name, const ClBuffer& buffer) {
  if (bound(name).get() == buffer.get()) return;
  checkCl(clRetainMemObject(buffer.get()), "clRetainMemObject");
  bound(name) = ClHandle<cl_mem, clReleaseMemObject>(buffer.get());
}

void OpenClStages::run(GpuStage stage, uint64_t count) {
  const bool traces = tracesRays(stage);
  const uint64_t items = traces ? (count + lanes_ - 1) / lanes_ : count;
  const uint32_t local = traces ? local_ : SL_LIST_GROUP;
  const ClKernel& kernel = kernels_[uint32_t(stage)];
  launch_.item_count = static_cast<uint32_t>(count);
  if (stage == GpuStage::kTraceRays) {
    return launchOnScene(context_, kernel, items, local, scene_, bound(StageBuffer::rays).get(),
                         bound(StageBuffer::hits).get(), launch_.item_count);
  }
  if (stage == GpuStage::kTraceViews) {
    return launchOnScene(context_, kernel, items, local, scene_, bound(StageBuffer::views).get(),
                         launch_.resolution, launch_.item_count, bound(StageBuffer::view_triangles).get());
  }
  std::array<cl_mem, kStageBuffers> buffers;
  const std::vector<StageBuffer>& names = buffers_of_[uint32_t(stage)];
  std::ranges::transform(names, buffers.begin(), [&](StageBuffer name) { return bound(name).get(); });
  launchOnScene(context_, kernel, items, local, scene_, launch_,
                std::span<const cl_mem>(buffers.data(), names.size()));
}

std::array<uint32_t, kCounterWords> OpenClStages::takeCounters() {
  std::array<uint32_t, kCounterWords> counters;
  context_.read(counters_, counters.data(), sizeof counters);
  context_.fill(counters_, 0, sizeof counters);
  return counters;
}

}  // namespace sightline
