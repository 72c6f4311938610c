#include "core/device/device.h"

#include "core/base/error.h"

namespace sightline {

HemicubeDrawer& Device::drawer() {
  throw Error(info().id + " cannot rasterise: only Vulkan devices rasterise", kExitUsage);
}

}  // namespace sightline
