#pragma once
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/device/vulkan/vulkan_device.h"

namespace sightline::testing_support {

/// Whether some Vulkan device can trace here. Where SIGHTLINE_REQUIRE_VULKAN is set (build.sh test sets it,
/// as it installs one), there being none is a failure and no reason to skip.
inline bool hasVulkan() {
  std::string reasons;
  for (const DeviceInfo& device : listVulkanDevices()) {
    if (device.unusable.empty()) return true;
    reasons += device.name + ": " + device.unusable + "; ";
  }
  if (std::getenv("SIGHTLINE_REQUIRE_VULKAN")) ADD_FAILURE() << "no Vulkan device can trace: " << reasons;
  return false;
}

}  // namespace sightline::testing_support

#define SL_SKIP_WITHOUT_VULKAN() \
  if (!sightline::testing_support::hasVulkan()) GTEST_SKIP() << "no Vulkan device"
