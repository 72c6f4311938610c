#include "core/opencl/opencl_context.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/opencl/opencl_devices.h"
#include "core/trace/parallel_copy.h"

namespace sightline {
namespace {

/// Names of the codes that users meet; others are told by number.
const char* codeName(cl_int code) {
#define SL_NAME(name) \
  case name:          \
    return #name;
  switch (code) {
    SL_NAME(CL_DEVICE_NOT_AVAILABLE)
    SL_NAME(CL_COMPILER_NOT_AVAILABLE)
    SL_NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE)
    SL_NAME(CL_OUT_OF_RESOURCES)
    SL_NAME(CL_OUT_OF_HOST_MEMORY)
    SL_NAME(CL_BUILD_PROGRAM_FAILURE)
    SL_NAME(CL_INVALID_VALUE)
    SL_NAME(CL_INVALID_BUFFER_SIZE)
    SL_NAME(CL_INVALID_BUILD_OPTIONS)
    SL_NAME(CL_INVALID_KERNEL_NAME)
    SL_NAME(CL_INVALID_KERNEL_ARGS)
    SL_NAME(CL_INVALID_ARG_INDEX)
    SL_NAME(CL_INVALID_ARG_SIZE)
    SL_NAME(CL_INVALID_ARG_VALUE)
    SL_NAME(CL_INVALID_MEM_OBJECT)
    SL_NAME(CL_INVALID_WORK_GROUP_SIZE)
    SL_NAME(CL_INVALID_WORK_ITEM_SIZE)
    default:
      return "OpenCL error";
  }
#undef SL_NAME
}

std::string buildLog(cl_program program, cl_device_id device) {
  size_t size = 0;
  if (clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size) != CL_SUCCESS)
    return {};
  std::string log(size, '\0');
  if (clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr) != CL_SUCCESS) {
    return {};
  }
  while (!log.empty() && (log.back() == '\0' || log.back() == '\n')) log.pop_back();
  return log;
}

/// Of readFast at a time.
constexpr uint64_t kPinnedBytes = 64u << 20;

double mebibytes(uint64_t bytes) {
  return double(bytes) / 1048576.0;
}

}  // namespace

void checkCl(cl_int code, const char* call) {
  if (code != CL_SUCCESS) throw Error(fmt::format("{} failed: {} ({})", call, codeName(code), code));
}

ClBuffer& ClBuffer::operator=(ClBuffer&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(total_, other.total_);
  return *this;
}

ClBuffer::~ClBuffer() {
  if (total_) *total_ -= bytes_;
}

OpenClContext::OpenClContext(const std::string& selector) : OpenClContext(selectOpenClDevice(selector)) {}

OpenClContext::OpenClContext(const OpenClDeviceChoice& device) : OpenClContext(device.id) {
  info_ = device.info;
}

OpenClContext::OpenClContext(cl_device_id device)
    : device_(device),
      is_cpu_((clDeviceValue<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0),
      max_allocation_(clDeviceValue<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE)),
      memory_limit_(clDeviceValue<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE)) {
  cl_int code = CL_SUCCESS;
  context_ =
      ClHandle<cl_context, clReleaseContext>(clCreateContext(nullptr, 1, &device_, nullptr, nullptr, &code));
  checkCl(code, "clCreateContext");
  queue_ = ClHandle<cl_command_queue, clReleaseCommandQueue>(
      clCreateCommandQueue(context_.get(), device_, 0, &code));
  checkCl(code, "clCreateCommandQueue");
}

void OpenClContext::build(const char* source, const std::string& options) {
  cl_int code = CL_SUCCESS;
  program_ = ClHandle<cl_program, clReleaseProgram>(
      clCreateProgramWithSource(context_.get(), 1, &source, nullptr, &code));
  checkCl(code, "clCreateProgramWithSource");
  code = clBuildProgram(program_.get(), 1, &device_, options.c_str(), nullptr, nullptr);
  if (code != CL_SUCCESS) {
    throw Error(fmt::format("{} ({}) could not compile the kernels with \"{}\": {} ({})", info_.id,
                            info_.name, options, codeName(code), code),
                kExitFailed, buildLog(program_.get(), device_));
  }
}

std::vector<std::string> argumentNames(const ClKernel& kernel) {
  cl_uint count = 0;
  checkCl(clGetKernelInfo(kernel.get(), CL_KERNEL_NUM_ARGS, sizeof count, &count, nullptr),
          "clGetKernelInfo");
  std::vector<std::string> names(count);
  for (cl_uint i = 0; i < count; ++i) {
    size_t bytes = 0;
    checkCl(clGetKernelArgInfo(kernel.get(), i, CL_KERNEL_ARG_NAME, 0, nullptr, &bytes),
            "clGetKernelArgInfo");
    std::string name(bytes, '\0');
    checkCl(clGetKernelArgInfo(kernel.get(), i, CL_KERNEL_ARG_NAME, bytes, name.data(), nullptr),
            "clGetKernelArgInfo");
    names[i] = name.c_str();
  }
  return names;
}

ClKernel OpenClContext::kernel(const char* name) const {
  cl_int code = CL_SUCCESS;
  ClKernel kernel(clCreateKernel(program_.get(), name, &code));
  checkCl(code, (std::string("clCreateKernel ") + name).c_str());
  return kernel;
}

ClBuffer OpenClContext::buffer(uint64_t bytes, const char* what) {
  bytes = std::max<uint64_t>(bytes, 16);
  const char* advice =
      "; use the device cpu, a smaller scene or, with PoCL, a higher POCL_MEMORY_LIMIT (GiB)";
  if (bytes > max_allocation_) {
    throw Error(
        fmt::format("{} ({}): the {} take {:.0f} MiB, more than the {:.0f} MiB that the device allows "
                    "one buffer{}",
                    info_.id, info_.name, what, mebibytes(bytes), mebibytes(max_allocation_), advice));
  }
  cl_int code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
  ClBuffer buffer;
  if (*allocated_ + bytes <= memory_limit_) {
    buffer.memory_ = ClHandle<cl_mem, clReleaseMemObject>(
        clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, bytes, nullptr, &code));
  }
  if (code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES) {
    const bool by_budget = *allocated_ + bytes > memory_limit_ && memory_limit_ < info_.memory_bytes;
    if (by_budget) advice = "; give a larger --memory-budget, or leave it out";
    throw Error(fmt::format(
        "{} ({}): the {} take {:.1f} MiB, but {:.1f} of the {:.1f} MiB that it may use are in use{}",
        info_.id, info_.name, what, mebibytes(bytes), mebibytes(*allocated_), mebibytes(memory_limit_),
        advice));
  }
  checkCl(code, "clCreateBuffer");
  buffer.bytes_ = bytes;
  buffer.total_ = allocated_;
  *allocated_ += bytes;
  return buffer;
}

void OpenClContext::write(const ClBuffer& buffer, const void* source, uint64_t bytes, uint64_t offset) {
  if (bytes == 0) return;
  checkCl(
      clEnqueueWriteBuffer(queue_.get(), buffer.get(), CL_TRUE, offset, bytes, source, 0, nullptr, nullptr),
      "clEnqueueWriteBuffer");
}

void OpenClContext::read(const ClBuffer& buffer, void* target, uint64_t bytes, uint64_t offset) {
  if (bytes == 0) return;
  checkCl(
      clEnqueueReadBuffer(queue_.get(), buffer.get(), CL_TRUE, offset, bytes, target, 0, nullptr, nullptr),
      "clEnqueueReadBuffer");
}

void OpenClContext::readFast(const ClBuffer& buffer, void* target, uint64_t bytes) {
  if (is_cpu_) return read(buffer, target, bytes);
  cl_int code = CL_SUCCESS;
  if (pinned_address_ == nullptr) {  // stays mapped as long as the context lives
    pinned_ = ClHandle<cl_mem, clReleaseMemObject>(clCreateBuffer(
        context_.get(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, kPinnedBytes, nullptr, &code));
    checkCl(code, "clCreateBuffer");
    pinned_address_ = clEnqueueMapBuffer(queue_.get(), pinned_.get(), CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0,
                                         kPinnedBytes, 0, nullptr, nullptr, &code);
    checkCl(code, "clEnqueueMapBuffer");
  }
  for (uint64_t first = 0; first < bytes; first += kPinnedBytes) {
    const uint64_t count = std::min(kPinnedBytes, bytes - first);
    read(buffer, pinned_address_, count, first);
    parallelCopy(static_cast<char*>(target) + first, pinned_address_, count);
  }
}

void OpenClContext::fill(const ClBuffer& buffer, uint32_t value, uint64_t bytes, uint64_t offset) {
  if (bytes == 0) return;
  checkCl(clEnqueueFillBuffer(queue_.get(), buffer.get(), &value, sizeof value, offset, bytes, 0, nullptr,
                              nullptr),
          "clEnqueueFillBuffer");
}

void OpenClContext::copy(const ClBuffer& from, const ClBuffer& to, uint64_t bytes) {
  if (bytes == 0) return;
  checkCl(clEnqueueCopyBuffer(queue_.get(), from.get(), to.get(), 0, 0, bytes, 0, nullptr, nullptr),
          "clEnqueueCopyBuffer");
}

void OpenClContext::enqueue(const ClKernel& kernel, uint64_t global, uint32_t local) {
  if (global == 0) return;
  const size_t local_size = local;
  const size_t global_size = local ? (global + local - 1) / local * local : global;
  checkCl(clEnqueueNDRangeKernel(queue_.get(), kernel.get(), 1, nullptr, &global_size,
                                 local ? &local_size : nullptr, 0, nullptr, nullptr),
          "clEnqueueNDRangeKernel");
}

void OpenClContext::finish() {
  checkCl(clFinish(queue_.get()), "clFinish");
}

}  // namespace sightline
