#pragma once
#include <cstdint>

#include "core/device/cell_sampler.h"
#include "core/device/hemicube_drawer.h"
#include "core/trace/tracer.h"

namespace sightline {

/// How a device keeps the set of found triangles. The result is the same.
enum class SetKind { kAuto, kArray, kHash };

struct DeviceOptions {
  int threads = 0;               ///< cpu: at most; 0 = all cores (the process may have fewer or more: TBB)
  SetKind set = SetKind::kAuto;  ///< kAuto: array unless it would not fit the budget
  uint64_t memory_budget_bytes = 0;  ///< 0: what the device reports
  uint32_t work_group_size = 0;      ///< opencl, vulkan with ray queries: 0 = the device's own choice
  uint32_t rays_per_item = 0;        ///< opencl: packets of 8 rays or 1; 0 = what is fastest on the device
  uint32_t part_triangles = 0;  ///< vulkan: of a bottom-level acceleration structure at most; 0: its limit
  bool ray_queries = false;     ///< vulkan: in compute shaders, even where there are ray tracing pipelines
};

/// What bakes: traces any rays, samples view cells, and on some devices draws hemicubes. All parts share the
/// scene; take the narrowest that does.
class Device : public Tracer, public CellSampler {
 public:
  /// What draws into the sampler's batches. Throws Error (wrong usage) where the device has no such part.
  virtual HemicubeDrawer& drawer();
};

}  // namespace sightline
