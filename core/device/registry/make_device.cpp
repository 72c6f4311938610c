#include "core/device/registry/make_device.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/device/cpu/cpu_device.h"
#include "core/device/embree/embree_device.h"
#include "core/device/opencl/opencl_device.h"
#include "core/device/vulkan/vulkan_device.h"
#include "core/opencl/opencl_context.h"
#include "core/vulkan/vulkan_devices.h"

namespace sightline {

namespace {

/// The kind alone, or with ":" and a selection.
bool isOfKind(const std::string& name, const std::string& kind) {
  return name == kind || name.starts_with(kind + ":");
}

[[noreturn]] void throwUnknown(const std::string& name) {
  throw Error(fmt::format("device '{}': expected cpu, opencl, vulkan, or the latter two with :INDEX or "
                          ":PART-OF-NAME, or embree; 'sightline devices' lists what can run here",
                          name),
              kExitUsage);
}

}  // namespace

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> devices{cpuDeviceInfo()};
  for (DeviceInfo& device : listOpenClDevices()) devices.push_back(std::move(device));
  for (DeviceInfo& device : listVulkanDevices()) devices.push_back(std::move(device));
  devices.push_back(embreeDeviceInfo());
  return devices;
}

bool isDeviceName(const std::string& name) {
  return name == "cpu" || name == "embree" || isOfKind(name, "opencl") || isOfKind(name, "vulkan");
}

void requireDevice(const std::string& name) {
  if (isOfKind(name, "opencl")) {
    requireOpenClDevice(name);
  } else if (isOfKind(name, "vulkan")) {
    selectVulkanDevice(name);
  } else if (name == "embree") {
    requireEmbree();
  } else if (name != "cpu") {
    throwUnknown(name);
  }
}

std::string intersectorOf(const std::string& name) {
  if (!isOfKind(name, "vulkan")) return {};
  const DeviceInfo info = selectVulkanDevice(name).info;
  return info.name + ", " + info.driver;
}

std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == "cpu") return makeCpuDevice(scene, bvh, options);
  if (name == "embree") return makeEmbreeDevice(scene);
  if (isOfKind(name, "opencl")) return makeOpenClDevice(name, scene, bvh, options);
  if (isOfKind(name, "vulkan")) return makeVulkanDevice(name, scene, bvh, options);
  throwUnknown(name);
}

}  // namespace sightline
