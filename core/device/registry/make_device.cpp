#include "core/device/registry/make_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/base/error.h"
#include "core/device/cpu/cpu_device.h"
#include "core/device/embree/embree_device.h"
#ifdef SL_HAVE_OPENCL
#include "core/device/opencl/opencl_device.h"
#include "core/opencl/opencl_context.h"
#endif
#ifdef SL_HAVE_VULKAN
#include "core/device/vulkan/vulkan_device.h"
#endif

namespace sightline {

namespace {

/// A kind of devices of which there may be several: NAME, NAME:INDEX or NAME:PART-OF-NAME selects one.
struct Kind {
  const char* name;
  bool own_intersector;  ///< what rays hit is decided by the device and its driver
  const char* left_out;  ///< why this program has none; null: it has, and the rest is not null
  std::vector<DeviceInfo> (*list)();
  DeviceInfo (*require)(const std::string& selector);  ///< throws Error unless it selects a usable one
  std::unique_ptr<Device> (*make)(const std::string&, const Scene&, const Bvh&, const DeviceOptions&);
};

constexpr const char* kEmbree = "embree";

constexpr Kind kKinds[] = {
#ifdef SL_HAVE_OPENCL
    {"opencl", false, nullptr, listOpenClDevices, requireOpenClDevice, makeOpenClDevice},
#else
    {"opencl", false, "built without OpenCL (SL_WITH_OPENCL=OFF)", nullptr, nullptr, nullptr},
#endif
#ifdef SL_HAVE_VULKAN
    {"vulkan", true, nullptr, listVulkanDevices, requireVulkanDevice, makeVulkanDevice},
#else
    {"vulkan", true, "built without Vulkan (SL_WITH_VULKAN=OFF)", nullptr, nullptr, nullptr},
#endif
};

/// The kind that a name is of: alone, or with ":" and a selection. Null: of none.
const Kind* kindOf(const std::string& name) {
  const auto found = std::ranges::find_if(kKinds, [&](const Kind& kind) {
    return name == kind.name || name.starts_with(std::string(kind.name) + ":");
  });
  return found == std::end(kKinds) ? nullptr : found;
}

/// Throws Error if this program has none of the kind.
void requireKind(const Kind& kind, const std::string& name) {
  if (kind.left_out == nullptr) return;
  throw Error(fmt::format("device \"{}\": this program was {}", name, kind.left_out));
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
  for (const Kind& kind : kKinds) {
    if (kind.left_out != nullptr) {
      DeviceInfo info;
      info.id = info.name = kind.name;
      info.unusable = kind.left_out;
      devices.push_back(std::move(info));
      continue;
    }
    for (DeviceInfo& device : kind.list()) devices.push_back(std::move(device));
  }
  devices.push_back(embreeDeviceInfo());
  return devices;
}

bool isDeviceName(const std::string& name) {
  return name == "cpu" || name == kEmbree || kindOf(name) != nullptr;
}

DeviceInfo requireDevice(const std::string& name) {
  if (const Kind* kind = kindOf(name)) {
    requireKind(*kind, name);
    return kind->require(name);
  }
  if (name == kEmbree) return requireEmbree();
  if (name == "cpu") return cpuDeviceInfo();
  throwUnknown(name);
}

std::string intersectorOf(const std::string& name) {
  if (!isDeviceName(name)) throwUnknown(name);
  const Kind* kind = kindOf(name);
  return kind && kind->own_intersector ? intersectorOf(requireDevice(name)) : "";
}

std::string whyNoBakes(const std::string& name) {
  return name == kEmbree ? "embree traces rays for crosscheck and trace only; take cpu, opencl or vulkan"
                         : "";
}

std::unique_ptr<Device> makeDevice(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == "cpu") return makeCpuDevice(scene, bvh, options);
  if (const Kind* kind = kindOf(name)) {
    requireKind(*kind, name);
    return kind->make(name, scene, bvh, options);
  }
  if (const std::string why = whyNoBakes(name); !why.empty()) throw Error(why, kExitUsage);
  throwUnknown(name);
}

std::unique_ptr<Tracer> makeTracer(const std::string& name, const Scene& scene, const Bvh& bvh,
                                   const DeviceOptions& options) {
  if (name == kEmbree) return makeEmbreeTracer(scene);
  return makeDevice(name, scene, bvh, options);
}

}  // namespace sightline
