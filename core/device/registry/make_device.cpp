#include "core/device/registry/make_device.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/device/cpu/cpu_device.h"
#include "core/device/embree/embree_device.h"
#include "core/device/opencl/opencl_device.h"
#include "core/device/vulkan/vulkan_device.h"
#include "core/opencl/opencl_context.h"

namespace sightline {

namespace {

constexpr const char* kEmbree = "embree";

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
  return name == "cpu" || name == kEmbree || isOfKind(name, "opencl") || isOfKind(name, "vulkan");
}

DeviceInfo requireDevice(const std::string& name) {
  if (isOfKind(name, "opencl")) return requireOpenClDevice(name);
  if (isOfKind(name, "vulkan")) return requireVulkanDevice(name);
  if (name == kEmbree) return requireEmbree();
  if (name == "cpu") return cpuDeviceInfo();
  throwUnknown(name);
}

std::string whyNoBakes(const std::string& name) {
  return name == kEmbree ? "embree traces rays for crosscheck and trace only; take cpu, opencl or vulkan"
                         : "";
}

std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == "cpu") return makeCpuDevice(scene, bvh, options);
  if (isOfKind(name, "opencl")) return makeOpenClDevice(name, scene, bvh, options);
  if (isOfKind(name, "vulkan")) return makeVulkanDevice(name, scene, bvh, options);
  if (const std::string why = whyNoBakes(name); !why.empty()) throw Error(why, kExitUsage);
  throwUnknown(name);
}

std::unique_ptr<Tracer> makeTracer(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == kEmbree) return makeEmbreeTracer(scene);
  return makeDevice(name, scene, bvh, options);
}

}  // namespace sightline
