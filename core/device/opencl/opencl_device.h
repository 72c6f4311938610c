#pragma once
#include <memory>
#include <string>

#include "bvh/bvh.h"
#include "core/device/device.h"
#include "core/scene/scene.h"

namespace sightline {

/// An OpenCL 1.2 device that runs all stages as kernels (cl_kernels), with scene, set and list in its memory.
/// selector: as of OpenClContext. `scene` is not needed afterwards. Throws Error.
std::unique_ptr<Device> makeOpenClDevice(const std::string& selector, const Scene& scene, const Bvh& bvh,
                                         const DeviceOptions& options);

}  // namespace sightline
