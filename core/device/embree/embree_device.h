#pragma once
#include <memory>

#include "core/device/trace_only_device.h"

namespace sightline {

/// Embree 3, the tracer of others, as a peer to compare with; unusable where the program was built without
/// it.
DeviceInfo embreeDeviceInfo();

/// Throws Error where it is unusable.
void requireEmbree();

/// Traces by Embree in its robust mode, single rays, on all threads. Which of equally near triangles it names
/// is its own choice. Throws Error.
std::unique_ptr<Device> makeEmbreeDevice(const Scene& scene);

}  // namespace sightline
