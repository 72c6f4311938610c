#pragma once
#include <string>
#include <vector>

#include "core/trace/device_info.h"

// Names of devices: "cpu"; "opencl" or "vulkan", alone (the best there is), with ":INDEX" or with
// ":PART-OF-NAME" (any case); "embree", which only traces rays for comparisons.
namespace sightline {

/// Devices that this machine has, the unusable ones with their reason, among them the kinds that the library
/// was built without. Loads drivers, which may take a second.
std::vector<DeviceInfo> listDevices();

/// Throws Error that lists what there is if `name` selects no device that can run here: at once, before the
/// work that a tree takes.
void requireDevice(const std::string& name);

/// Whose intersection test decides what rays hit on the device that `name` selects: empty for that of
/// core/shared, whose sets are the same on every device; else (vulkan) the device's name and its driver's
/// version. Throws Error as requireDevice, where it must look at the device.
std::string intersectorOf(const std::string& name);

/// Whether the name could be one: it is of a kind above.
bool isDeviceName(const std::string& name);

}  // namespace sightline
