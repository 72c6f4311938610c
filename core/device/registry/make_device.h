#pragma once
#include <memory>
#include <string>

#include "core/device/device.h"
#include "core/device/registry/device_names.h"

namespace sightline {

/// Makes the device that `name` selects and uploads the scene: "cpu", "opencl", "opencl:INDEX",
/// "opencl:PART-OF-NAME", or the same with "vulkan". Throws Error that lists what there is.
std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options = {});

}  // namespace sightline
