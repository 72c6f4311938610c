#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/device/device.h"
#include "core/device/gpu/gpu_stage.h"
#include "core/device/opencl/opencl_scene.h"
#include "core/shared/counters.h"

namespace sightline {

/// The stages as OpenCL kernels (cl_kernels): the API of a GpuSampler. A kernel's parameters bear the names
/// of the buffers that it takes; those that none was bound to are small dummies.
class OpenClStages {
 public:
  using Buffer = ClBuffer;

  /// selector: as of OpenClContext. `scene` is not needed afterwards. Throws Error.
  OpenClStages(const std::string& selector, const Scene& scene, const Bvh& bvh, const DeviceOptions& options);

  const DeviceInfo& info() const { return context_.info(); }
  bool fits(uint64_t bytes) const { return context_.fits(bytes); }
  uint64_t allocatedBytes() const { return context_.allocatedBytes(); }

  ClBuffer buffer(uint64_t bytes, const char* what) { return context_.buffer(bytes, what); }
  void release(ClBuffer& buffer);
  void write(const ClBuffer& buffer, const void* data, uint64_t bytes) {
    context_.write(buffer, data, bytes);
  }
  void read(const ClBuffer& buffer, void* target, uint64_t bytes);
  void fill(const ClBuffer& buffer, uint32_t word, uint64_t bytes) { context_.fill(buffer, word, bytes); }
  void copy(const ClBuffer& from, const ClBuffer& to, uint64_t bytes) { context_.copy(from, to, bytes); }

  StageLaunch& launch() { return launch_; }
  void bind(StageBuffer name, const ClBuffer& buffer);
  void prepare(std::span<const GpuStage>) {}  // the program was built at once
  void run(GpuStage stage, uint64_t count);
  std::array<uint32_t, kCounterWords> takeCounters();

 private:
  ClHandle<cl_mem, clReleaseMemObject>& bound(StageBuffer name) { return bound_[uint32_t(name)]; }

  OpenClContext context_;
  uint32_t lanes_;      ///< rays a work item
  uint32_t local_ = 0;  ///< work-group size of the stages that trace
  OpenClScene scene_;
  ClBuffer dummy_, record_of_, counters_;
  std::array<ClKernel, kGpuStages> kernels_;
  std::array<std::vector<StageBuffer>, kGpuStages> buffers_of_;            ///< that each takes, in order
  std::array<ClHandle<cl_mem, clReleaseMemObject>, kStageBuffers> bound_;  ///< each holds a reference
  StageLaunch launch_{};
};

}  // namespace sightline
