#pragma once
#include "core/walk/walk_device.h"

namespace sightline {

/// Throws Error where no device of this selector draws.
void requireVulkanWalkDevice(const std::string& selector);

/// Draws on a Vulkan device (core/draw/vulkan). selector: as of VulkanDrawing.
std::unique_ptr<WalkDevice> makeVulkanWalkDevice(const std::string& selector, const WalkScene& scene,
                                                 WalkClock clock, const WalkDeviceOptions& options);

}  // namespace sightline
