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

/// What `name` selects. Throws Error that lists what there is if that is no device that can run here: at
/// once, before the work that a tree takes.
DeviceInfo requireDevice(const std::string& name);

/// Whose intersection test decides what rays hit on the device that `name` selects (intersectorOf its
/// DeviceInfo). Looks at the device only where it has a test of its own (vulkan); throws Error as
/// requireDevice then, and for a name of no kind.
std::string intersectorOf(const std::string& name);

/// Whether the name could be one: it is of a kind above.
bool isDeviceName(const std::string& name);

/// Why a device of that name does not bake, in one line; empty: it does.
std::string whyNoBakes(const std::string& name);

}  // namespace sightline
