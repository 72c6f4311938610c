#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/device/device.h"

namespace sightline {

/// Devices that this machine has, the unusable ones with their reason.
std::vector<DeviceInfo> listDevices();

/// Throws Error as makeDevice would if `name` selects no device that can run here: at once, before the work
/// that a tree takes.
void requireDevice(const std::string& name);

/// Whose intersection test decides what rays hit on the device that `name` selects: empty for that of
/// core/shared, whose sets are the same on every device; else (vulkan) the device's name and its driver's
/// version. Throws Error as requireDevice, where it must look at the device.
std::string intersectorOf(const std::string& name);

/// Whether makeDevice could know the name: "cpu"; "opencl" or "vulkan", alone or with ":" and more.
bool isDeviceName(const std::string& name);

/// Makes the device that `name` selects and uploads the scene: "cpu", "opencl", "opencl:INDEX",
/// "opencl:PART-OF-NAME", or the same with "vulkan". Throws Error that lists what there is.
std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options = {});

}  // namespace sightline
