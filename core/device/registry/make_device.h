#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/device/device.h"
#include "core/scene/scene.h"

namespace sightline {

/// Devices that this machine has, the unusable ones with their reason.
std::vector<DeviceInfo> listDevices();

/// What `name` selects. Throws Error as makeTracer would if that is no device that can run here: at once,
/// before the work that a tree takes.
DeviceInfo requireDevice(const std::string& name);

/// Whether makeTracer could know the name: "cpu" or "embree"; "opencl" or "vulkan", alone or with ":" and
/// more.
bool isDeviceName(const std::string& name);

/// Why makeDevice refuses a name that makeTracer knows, in one line; empty: it does not.
std::string whyNoBakes(const std::string& name);

/// Makes the device that `name` selects and uploads the scene: "cpu", "opencl", "opencl:INDEX",
/// "opencl:PART-OF-NAME", or the same with "vulkan". Throws Error that lists what there is.
std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options = {});

/// The same where rays are all that is asked for: also "embree", which bakes nothing.
std::unique_ptr<Tracer> makeTracer(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options = {});

}  // namespace sightline
