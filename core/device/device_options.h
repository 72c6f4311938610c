#pragma once
#include <cstdint>

namespace sightline {

/// How a device keeps the set of found triangles. The result is the same.
enum class SetKind { kAuto, kArray, kHash };

/// How a device works. None of it changes what it finds.
struct DeviceOptions {
  int threads = 0;                   ///< cpu: at most; 0 = all cores (the process may have fewer or more: TBB)
  SetKind set = SetKind::kAuto;      ///< kAuto: array unless it would not fit the budget
  uint64_t memory_budget_bytes = 0;  ///< 0: what the device reports
  uint32_t work_group_size = 0;      ///< opencl, vulkan with ray queries: 0 = the device's own choice
  uint32_t rays_per_item = 0;        ///< opencl: packets of 8 rays or 1; 0 = what is fastest on the device
  uint32_t part_triangles = 0;  ///< vulkan: of a bottom-level acceleration structure at most; 0: its limit
  bool ray_queries = false;     ///< vulkan: in compute shaders, even where there are ray tracing pipelines
};

}  // namespace sightline
