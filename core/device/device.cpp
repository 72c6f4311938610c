#include "core/device/device.h"

#include <fmt/format.h>

#include "core/device/cpu_device.h"
#include "core/device/opencl_context.h"
#include "core/device/opencl_device.h"
#include "core/error.h"

namespace sightline {

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> devices{cpuDeviceInfo()};
  for (DeviceInfo& device : listOpenClDevices()) devices.push_back(std::move(device));
  return devices;
}

std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == "cpu") return makeCpuDevice(scene, bvh, options);
  if (name == "opencl" || name.starts_with("opencl:")) return makeOpenClDevice(name, scene, bvh, options);
  throw Error(fmt::format("device '{}': expected cpu, opencl, opencl:INDEX or opencl:PART-OF-NAME; "
                          "'sightline devices' lists what can run here",
                          name),
              kExitUsage);
}

}  // namespace sightline
