#include <fmt/format.h>

#include "core/base/error.h"
#include "core/walk/software_walk_device.h"
#ifdef SL_WITH_VULKAN
#include "core/walk/vulkan_walk_device.h"
#endif

namespace sightline {

std::unique_ptr<WalkDevice> makeWalkDevice(const std::string& name, const WalkScene& scene, WalkClock clock) {
  if (name == "cpu") return makeSoftwareWalkDevice(scene, std::move(clock));
  if (name == "vulkan" || name.starts_with("vulkan:")) {
#ifdef SL_WITH_VULKAN
    return makeVulkanWalkDevice(name, scene, std::move(clock));
#else
    throw Error(
        "walk: this program was built without Vulkan (SL_WITH_VULKAN=OFF); --device cpu draws on the "
        "processor");
#endif
  }
  throw Error(
      fmt::format("no device \"{}\" draws; there are vulkan, vulkan:INDEX, vulkan:PART-OF-NAME and cpu",
                  name),
      kExitUsage);
}

}  // namespace sightline
