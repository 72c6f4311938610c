#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/device/device.h"
#include "core/scene/scene.h"

namespace sightline {

/// A Vulkan 1.2 device with hardware or driver ray tracing that runs all stages as shaders (vk_shaders), with
/// scene, trees, set and list in its memory. The rays are those of the other devices, bit for bit; the
/// nearest hit is the driver's answer, so t may differ in the last bits, among hits at equal distance any may
/// win, and rays through edges and vertices may be lost. selector: as of selectVulkanDevice. `scene` is not
/// needed afterwards. Throws Error.
std::unique_ptr<Device> makeVulkanDevice(const std::string& selector, const Scene& scene, const Bvh& bvh,
                                         const DeviceOptions& options);

/// The device that a selector (of selectVulkanDevice) means, which can trace. Throws Error.
DeviceInfo requireVulkanDevice(const std::string& selector);

/// For `sightline devices`: each with why it cannot trace, if it cannot; empty where there is no Vulkan
/// loader or no driver. Never throws.
std::vector<DeviceInfo> listVulkanDevices();

}  // namespace sightline
