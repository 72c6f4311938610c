#pragma once
#include <memory>

#include "bvh/bvh.h"
#include "core/device/device.h"
#include "core/scene/scene.h"

namespace sightline {

/// The reference device: the shared code in C++ on all cores, usable without any driver. `scene` must outlive
/// it. Throws Error when the memory budget cannot hold the scene.
std::unique_ptr<Device> makeCpuDevice(const Scene& scene, const Bvh& bvh, const DeviceOptions& options);

/// Name and core count of this machine's processor.
DeviceInfo cpuDeviceInfo();

}  // namespace sightline
