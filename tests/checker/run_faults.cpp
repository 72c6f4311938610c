// Runs one kernel with a fault, named by the argument, or "clean", one without: what Oclgrind must find, and
// what it must not (faults_test.sh).
#include <fmt/format.h>

#include <exception>

#include "core/opencl/opencl_context.h"

namespace sightline {
namespace {

constexpr size_t kItems = 64;

constexpr const char* kSource = R"(
__kernel void clean(volatile __global uint* slots) {
  if (atomic_or(&slots[0], 0u) > get_global_id(0)) atomic_min(&slots[0], (uint)get_global_id(0));
}
__kernel void race(volatile __global uint* slots) {
  if (slots[0] > get_global_id(0)) atomic_min(&slots[0], (uint)get_global_id(0));
}
__kernel void outOfBounds(volatile __global uint* slots) { slots[get_global_id(0) + 1] = 7u; }
)";

void run(const char* name) {
  cl_platform_id platform = nullptr;
  cl_device_id device = nullptr;
  checkCl(clGetPlatformIDs(1, &platform, nullptr), "clGetPlatformIDs");
  checkCl(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr), "clGetDeviceIDs");
  cl_int code = CL_SUCCESS;
  const ClHandle<cl_context, clReleaseContext> context(
      clCreateContext(nullptr, 1, &device, nullptr, nullptr, &code));
  checkCl(code, "clCreateContext");
  const ClHandle<cl_command_queue, clReleaseCommandQueue> queue(
      clCreateCommandQueue(context.get(), device, 0, &code));
  checkCl(code, "clCreateCommandQueue");
  const char* source = kSource;
  const ClHandle<cl_program, clReleaseProgram> program(
      clCreateProgramWithSource(context.get(), 1, &source, nullptr, &code));
  checkCl(code, "clCreateProgramWithSource");
  checkCl(clBuildProgram(program.get(), 1, &device, kClBuildOptions, nullptr, nullptr), "clBuildProgram");
  const ClKernel kernel(clCreateKernel(program.get(), name, &code));
  checkCl(code, "clCreateKernel");
  const ClHandle<cl_mem, clReleaseMemObject> buffer(
      clCreateBuffer(context.get(), CL_MEM_READ_WRITE, kItems * 4, nullptr, &code));
  checkCl(code, "clCreateBuffer");
  const cl_mem memory = buffer.get();
  const cl_uint value = 1000;
  checkCl(clEnqueueFillBuffer(queue.get(), memory, &value, 4, 0, kItems * 4, 0, nullptr, nullptr),
          "clEnqueueFillBuffer");
  checkCl(clSetKernelArg(kernel.get(), 0, sizeof memory, &memory), "clSetKernelArg");
  const size_t items = kItems, group = 8;
  checkCl(clEnqueueNDRangeKernel(queue.get(), kernel.get(), 1, nullptr, &items, &group, 0, nullptr, nullptr),
          "clEnqueueNDRangeKernel");
  checkCl(clFinish(queue.get()), "clFinish");
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  try {
    sightline::run(argc > 1 ? argv[1] : "clean");
  } catch (const std::exception& error) {
    fmt::print("{}\n", error.what());
    return 1;
  }
}
