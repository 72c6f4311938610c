#pragma once
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/trace/device_info.h"

namespace sightline {

/// What every program is compiled with.
inline constexpr const char* kClBuildOptions =
    "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt -cl-kernel-arg-info";

/// Throws Error that names the call and the code's name, if the code is not CL_SUCCESS.
void checkCl(cl_int code, const char* call);

/// Every OpenCL device, in the order of its index in "opencl:INDEX"; unusable ones with the reason. Empty
/// where no OpenCL driver is installed. Never throws for a missing or broken driver.
std::vector<DeviceInfo> listOpenClDevices();

/// Throws Error if the selector (see OpenClContext) selects no device that can run here.
DeviceInfo requireOpenClDevice(const std::string& selector);

/// Owns one reference to an OpenCL object.
template <typename Handle, cl_int(CL_API_CALL* kRelease)(Handle)>
class ClHandle {
 public:
  ClHandle() = default;
  explicit ClHandle(Handle handle) : handle_(handle) {}
  ClHandle(ClHandle&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  ClHandle& operator=(ClHandle&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~ClHandle() {
    if (handle_) kRelease(handle_);
  }
  Handle get() const { return handle_; }

 private:
  Handle handle_ = nullptr;
};

using ClKernel = ClHandle<cl_kernel, clReleaseKernel>;

/// Memory on the device; empty (0 bytes) by default.
class ClBuffer {
 public:
  ClBuffer() = default;
  ClBuffer(ClBuffer&& other) noexcept { *this = std::move(other); }
  ClBuffer& operator=(ClBuffer&& other) noexcept;
  ~ClBuffer();
  cl_mem get() const { return memory_.get(); }
  uint64_t bytes() const { return bytes_; }

 private:
  friend class OpenClContext;
  ClHandle<cl_mem, clReleaseMemObject> memory_;
  uint64_t bytes_ = 0;
  std::shared_ptr<uint64_t> total_;  ///< of the context: bytes in all its buffers
};

/// The names of a kernel's parameters, in order.
std::vector<std::string> argumentNames(const ClKernel& kernel);

struct OpenClDeviceChoice;

/// One device with its queue and, after build, its program. Commands run in order. Not thread-safe.
/// Everything throws Error with the name of the call that failed.
class OpenClContext {
 public:
  /// selector: "opencl" (a GPU if there is a usable one, else a CPU, else whatever), "opencl:INDEX" or
  /// "opencl:PART-OF-NAME" (any case, the first that matches). Throws Error that lists what there is.
  explicit OpenClContext(const std::string& selector);

  /// Of any device, also one that could not run ours; info() is not filled.
  explicit OpenClContext(cl_device_id device);

  const DeviceInfo& info() const { return info_; }
  bool isCpu() const { return is_cpu_; }
  uint64_t maxAllocationBytes() const { return max_allocation_; }
  /// Whether a buffer of this size is within the limits.
  bool fits(uint64_t bytes) const { return bytes <= max_allocation_ && *allocated_ + bytes <= memory_limit_; }
  uint64_t allocatedBytes() const { return *allocated_; }

  /// From now on buffers take so many bytes in all at most.
  void limitMemory(uint64_t bytes) { memory_limit_ = std::min(bytes, info_.memory_bytes); }

  /// Compiles a program in OpenCL C, which replaces that built before, with the compiler's options, such as
  /// "-cl-std=CL1.2". The Error of a failed build holds the log.
  void build(const char* source, const std::string& options);
  ClKernel kernel(const char* name) const;

  /// what: for the message when it does not fit ("triangles of the scene"). 0 bytes: a small dummy.
  ClBuffer buffer(uint64_t bytes, const char* what);
  /// Blocking copies; offsets in bytes.
  void write(const ClBuffer& buffer, const void* source, uint64_t bytes, uint64_t offset = 0);
  void read(const ClBuffer& buffer, void* target, uint64_t bytes, uint64_t offset = 0);
  void fill(const ClBuffer& buffer, uint32_t value, uint64_t bytes, uint64_t offset = 0);
  /// Copies the first bytes of a buffer into another.
  void copy(const ClBuffer& from, const ClBuffer& to, uint64_t bytes);
  /// read for much: through memory that the driver pinned, at the full speed of the bus.
  void readFast(const ClBuffer& buffer, void* target, uint64_t bytes);

  /// Enqueues a kernel over `global` work items (rounded up to whole groups: kernels check their range).
  /// local: work-group size, 0 lets the driver choose (then global is not rounded). args: ClBuffer, cl_mem,
  /// scalars or structs, or spans of buffers, in order. global 0 does nothing.
  template <typename... Args>
  void launch(const ClKernel& kernel, uint64_t global, uint32_t local, const Args&... args) {
    cl_uint index = 0;
    (setArgument(kernel, index, args), ...);
    enqueue(kernel, global, local);
  }
  /// Waits for everything enqueued.
  void finish();

 private:
  explicit OpenClContext(const OpenClDeviceChoice& device);
  template <typename Arg>
  void setArgument(const ClKernel& kernel, cl_uint& index, const Arg& arg) {
    if constexpr (std::is_same_v<Arg, ClBuffer>) {
      setArgument(kernel, index, arg.get());
    } else {
      static_assert(std::is_trivially_copyable_v<Arg>);
      checkCl(clSetKernelArg(kernel.get(), index++, sizeof arg, &arg), "clSetKernelArg");
    }
  }
  void setArgument(const ClKernel& kernel, cl_uint& index, std::span<const cl_mem> buffers) {
    for (const cl_mem buffer : buffers) setArgument(kernel, index, buffer);
  }
  void enqueue(const ClKernel& kernel, uint64_t global, uint32_t local);

  cl_device_id device_ = nullptr;
  DeviceInfo info_;
  bool is_cpu_ = false;
  uint64_t max_allocation_ = 0;
  uint64_t memory_limit_ = 0;  ///< bytes that all buffers may take
  std::shared_ptr<uint64_t> allocated_ = std::make_shared<uint64_t>(0);
  ClHandle<cl_context, clReleaseContext> context_;
  ClHandle<cl_command_queue, clReleaseCommandQueue> queue_;
  ClHandle<cl_program, clReleaseProgram> program_;
  ClHandle<cl_mem, clReleaseMemObject> pinned_;  ///< of readFast, made when it is first needed
  void* pinned_address_ = nullptr;
};

}  // namespace sightline
