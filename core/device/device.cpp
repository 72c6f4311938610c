#include "core/device/device.h"

#include "core/base/error.h"

namespace sightline {

void Device::rasterize(std::span<const ViewFrame>, uint32_t, float) {
  throw Error(info().id + " cannot rasterise: " + whyNoRaster(), kExitUsage);
}

}  // namespace sightline
