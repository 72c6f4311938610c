#include <fmt/format.h>

#include "core/base/error.h"
#include "core/walk/software_walk_device.h"
#ifdef SL_WITH_VULKAN
#include "core/walk/vulkan_walk_device.h"
#endif

namespace sightline {

void requireWalkDevice(const std::string& name) {
  if (name == "cpu") return;
  if (name != "vulkan" && !name.starts_with("vulkan:")) {
    throw Error(
        fmt::format("no device \"{}\" draws; there are vulkan, vulkan:INDEX, vulkan:PART-OF-NAME and cpu",
                    name),
        kExitUsage);
  }
#ifdef SL_WITH_VULKAN
  requireVulkanWalkDevice(name);
#else
  throw Error(
      "walk: this program was built without Vulkan (SL_WITH_VULKAN=OFF); --device cpu draws on the "
      "processor");
#endif
}

std::unique_ptr<WalkDevice> makeWalkDevice(const std::string& name, const WalkScene& scene, WalkClock clock,
                                           [[maybe_unused]] const WalkDeviceOptions& options) {
  requireWalkDevice(name);
#ifdef SL_WITH_VULKAN
  if (name != "cpu") return makeVulkanWalkDevice(name, scene, std::move(clock), options);
#endif
  return makeSoftwareWalkDevice(scene, std::move(clock));
}

}  // namespace sightline
