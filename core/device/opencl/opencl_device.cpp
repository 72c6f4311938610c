#include "core/device/opencl/opencl_device.h"

#include "core/device/gpu/gpu_sampler.h"
#include "core/device/opencl/opencl_stages.h"

namespace sightline {

std::unique_ptr<Device> makeOpenClDevice(const std::string& selector, const Scene& scene, const Bvh& bvh,
                                         const DeviceOptions& options) {
  return std::make_unique<GpuSampler<OpenClStages>>(scene, options, selector, scene, bvh, options);
}

}  // namespace sightline
