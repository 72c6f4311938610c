#pragma once
#include <memory>
#include <string>

#include "bvh/bvh.h"
#include "core/device/device.h"
#include "core/device/registry/device_names.h"
#include "core/scene/scene.h"

namespace sightline {

/// Makes the device that `name` selects and uploads the scene: "cpu", "opencl", "opencl:INDEX",
/// "opencl:PART-OF-NAME", or the same with "vulkan". Throws Error that lists what there is.
std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options = {});

/// The same where rays are all that is asked for: also "embree", which bakes nothing.
std::unique_ptr<Tracer> makeTracer(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options = {});

}  // namespace sightline
