#pragma once
// Which OpenCL devices there are; used by opencl_context.cpp.
#include "core/opencl/opencl_context.h"

namespace sightline {

/// A device found, and what decides whether and how it is used.
struct OpenClDeviceChoice {
  cl_device_id id = nullptr;
  cl_device_type type = 0;
  DeviceInfo info;
};

/// All devices of all platforms; a platform that fails to answer is left out.
std::vector<OpenClDeviceChoice> findOpenClDevices();

/// Why the results of a device with such floats and doubles would differ from other devices', in one line;
/// empty: they do not. The arguments: CL_DEVICE_SINGLE_FP_CONFIG and CL_DEVICE_DOUBLE_FP_CONFIG.
std::string whyFloatsDiffer(cl_device_fp_config floats, cl_device_fp_config doubles);

/// The device for a selector (see OpenClContext). Throws Error.
OpenClDeviceChoice selectOpenClDevice(const std::string& selector);

/// A fixed-size property of a device.
template <typename T>
T clDeviceValue(cl_device_id device, cl_device_info property) {
  T value{};
  checkCl(clGetDeviceInfo(device, property, sizeof value, &value, nullptr), "clGetDeviceInfo");
  return value;
}

}  // namespace sightline
