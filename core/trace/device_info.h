#pragma once
#include <cstdint>
#include <string>

namespace sightline {

/// What a device is, for reports and `sightline devices`.
struct DeviceInfo {
  std::string id;        ///< what --device takes: "cpu", "opencl:0", "vulkan:0"
  std::string name;      ///< e.g. the OpenCL device's name
  std::string driver;    ///< version
  std::string layout;    ///< tree layout and kind of traversal, e.g. "bvh2, packets of 8"
  std::string unusable;  ///< why it cannot run; empty: it can
  uint64_t memory_bytes = 0;
  bool on_cpu = false;  ///< a processor does the work (cpu, PoCL, lavapipe): fewer rays are to be had
  bool exact = false;   ///< traces by core/shared/triangle.h, as cpu and opencl do: same sets, bit for bit
  bool naive = false;   ///< makeNaiveDevice made it: the host samples, hit by hit
  // The driver's own trees (vulkan), once a scene is on the device; else 0.
  uint32_t driver_tree_parts = 0;        ///< bottom-level acceleration structures
  uint64_t driver_tree_bytes = 0;        ///< of all acceleration structures
  double driver_tree_build_seconds = 0;  ///< with compaction
};

/// Whose intersection test decides what rays hit there: empty for that of core/shared, whose sets are the
/// same on every device; else the device's name and its driver's version.
inline std::string intersectorOf(const DeviceInfo& device) {
  return device.exact ? std::string() : device.name + ", " + device.driver;
}

}  // namespace sightline
