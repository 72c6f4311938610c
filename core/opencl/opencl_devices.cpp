#include "core/opencl/opencl_devices.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/opencl/opencl_rounding.h"
#include "core/trace/select_device.h"

namespace sightline {
namespace {

std::string clDeviceText(cl_device_id device, cl_device_info property) {
  size_t size = 0;
  checkCl(clGetDeviceInfo(device, property, 0, nullptr, &size), "clGetDeviceInfo");
  std::string text(size, '\0');
  checkCl(clGetDeviceInfo(device, property, size, text.data(), nullptr), "clGetDeviceInfo");
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

/// Tests run the kernels on a simulator that rounds correctly and does not say so (docs/numerics.md). Not for
/// users: a compiler may divide otherwise in another kernel, by a constant or in a vector, so that trying
/// proves nothing about the sets of a device that does not promise it.
bool mayTryRounding() {
  const char* value = std::getenv("SIGHTLINE_TEST_TRY_ROUNDING");
  return value && std::string_view(value) == "1";
}

/// Why a device cannot run the program; empty: it can.
std::string whyUnusable(cl_device_id device) {
  if (!clDeviceValue<cl_bool>(device, CL_DEVICE_AVAILABLE)) return "the device is not available";
  if (!clDeviceValue<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE)) return "its driver has no compiler";
  if (!clDeviceValue<cl_bool>(device, CL_DEVICE_ENDIAN_LITTLE)) return "it is big-endian";
  auto floats = clDeviceValue<cl_device_fp_config>(device, CL_DEVICE_SINGLE_FP_CONFIG);
  if ((floats & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) == 0 && mayTryRounding() && roundsCorrectly(device)) {
    floats |= CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
  }
  return whyFloatsDiffer(floats, clDeviceValue<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG));
}

OpenClDeviceChoice describeDevice(cl_device_id id, size_t index) {
  OpenClDeviceChoice device;
  device.id = id;
  device.info.id = fmt::format("opencl:{}", index);
  device.info.exact = true;
  try {
    device.type = clDeviceValue<cl_device_type>(id, CL_DEVICE_TYPE);
    device.info.name = clDeviceText(id, CL_DEVICE_NAME);
    device.info.driver =
        clDeviceText(id, CL_DEVICE_VERSION) + ", driver " + clDeviceText(id, CL_DRIVER_VERSION);
    device.info.layout = device.type & CL_DEVICE_TYPE_CPU ? "bvh2, packets of 8 rays" : "bvh2, single rays";
    device.info.on_cpu = (device.type & CL_DEVICE_TYPE_CPU) != 0;
    device.info.memory_bytes = clDeviceValue<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
    device.info.unusable = whyUnusable(id);
  } catch (const Error& error) {
    device.info.unusable = error.what();
  }
  return device;
}

/// GPUs before CPUs before the rest.
int rank(const OpenClDeviceChoice& device) {
  return device.type & CL_DEVICE_TYPE_GPU ? 0 : (device.type & CL_DEVICE_TYPE_CPU ? 1 : 2);
}

}  // namespace

std::string whyFloatsDiffer(cl_device_fp_config floats, cl_device_fp_config doubles) {
  if (doubles == 0) return "it has no double precision, which close calls of the intersection test take";
  const std::pair<cl_device_fp_config, const char*> needed[] = {
      {CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, "divide correctly rounded (CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)"},
      {CL_FP_ROUND_TO_NEAREST, "round floats to nearest (CL_FP_ROUND_TO_NEAREST)"},
      {CL_FP_DENORM, "keep floats below 2^-126 (CL_FP_DENORM)"},
      {CL_FP_INF_NAN, "compute with infinity (CL_FP_INF_NAN)"}};
  for (const auto& [flag, what] : needed) {
    if ((floats & flag) == 0) {
      return fmt::format("it does not {}, so that its results would differ from other devices'", what);
    }
  }
  return {};
}

std::vector<OpenClDeviceChoice> findOpenClDevices() {
  std::vector<OpenClDeviceChoice> devices;
  cl_uint platform_count = 0;
  // Without an installed driver the loader answers with an error; that is no failure of ours.
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS) return devices;
  std::vector<cl_platform_id> platforms(platform_count);
  if (clGetPlatformIDs(platform_count, platforms.data(), nullptr) != CL_SUCCESS) return devices;
  for (cl_platform_id platform : platforms) {
    cl_uint count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(count);
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr) != CL_SUCCESS) continue;
    for (cl_device_id id : ids) devices.push_back(describeDevice(id, devices.size()));
  }
  return devices;
}

OpenClDeviceChoice selectOpenClDevice(const std::string& selector) {
  return selectDevice(
      selector, "opencl", findOpenClDevices(), rank,
      "no OpenCL device found: install a driver (Debian: pocl-opencl-icd runs on any processor; it "
      "needs a cache folder that it can write: POCL_CACHE_DIR, else ~/.cache), or take --device cpu");
}

DeviceInfo requireOpenClDevice(const std::string& selector) {
  return selectOpenClDevice(selector).info;
}

std::vector<DeviceInfo> listOpenClDevices() {
  std::vector<DeviceInfo> list;
  for (OpenClDeviceChoice& device : findOpenClDevices()) list.push_back(std::move(device.info));
  return list;
}

}  // namespace sightline
