#include "core/device/device.h"

#include <fmt/format.h>

#include "core/device/cpu_device.h"
#include "core/device/opencl_context.h"
#include "core/device/opencl_device.h"
#include "core/error.h"

namespace sightline {

namespace {

bool isOpenCl(const std::string& name) {
  return name == "opencl" || name.starts_with("opencl:");
}

[[noreturn]] void throwUnknown(const std::string& name) {
  throw Error(fmt::format("device '{}': expected cpu, opencl, opencl:INDEX or opencl:PART-OF-NAME; "
                          "'sightline devices' lists what can run here",
                          name),
              kExitUsage);
}

}  // namespace

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> devices{cpuDeviceInfo()};
  for (DeviceInfo& device : listOpenClDevices()) devices.push_back(std::move(device));
  return devices;
}

void requireDevice(const std::string& name) {
  if (isOpenCl(name)) {
    requireOpenClDevice(name);
  } else if (name != "cpu") {
    throwUnknown(name);
  }
}

std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == "cpu") return makeCpuDevice(scene, bvh, options);
  if (isOpenCl(name)) return makeOpenClDevice(name, scene, bvh, options);
  throwUnknown(name);
}

}  // namespace sightline
