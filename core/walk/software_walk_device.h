#pragma once
#include "core/walk/walk_device.h"

namespace sightline {

/// Draws on the processor, bit for bit the same everywhere.
std::unique_ptr<WalkDevice> makeSoftwareWalkDevice(const WalkScene& scene, WalkClock clock);

}  // namespace sightline
