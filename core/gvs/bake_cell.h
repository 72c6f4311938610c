#pragma once
#include <atomic>
#include <functional>
#include <span>

#include "core/base/interrupted.h"
#include "core/device/device.h"
#include "core/gvs/bake_progress.h"
#include "core/gvs/bake_trace.h"
#include "core/pvs/bake_params.h"
#include "core/pvs/cell_pvs.h"
#include "core/scene/scene.h"

namespace sightline {

/// Told about the bake; called on the caller's thread.
using ProgressCallback = std::function<void(const BakeProgress&)>;

/// What bakeCell may be asked for besides the set; nothing but most_listed and hidden changes the set.
struct BakeHooks {
  ProgressCallback progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends the bake with Interrupted when it becomes true
  BakeTrace* trace = nullptr;               ///< is replaced by how the set grew
  uint32_t most_listed = 1u << 25;  ///< discontinuities that may wait (16 bytes each on the device) before no
                                    ///< more are listed; for tests: another bound may change the set
  /// Triangles that are known to be hidden: ascending. They do not enter the set, and what sees them by a
  /// leak is not explored.
  std::span<const uint32_t> hidden = {};
};

/// Throws Error (wrong usage) that names the parameter that is out of range.
void checkParams(const BakeParams& params);

/// Throws Error (wrong usage) if no device of that name (of makeDevice) could run the method: raster needs
/// Vulkan.
void requireMethodOn(Method method, const std::string& device);

/// Throws Error (wrong usage) if the method draws, which takes every triangle as opaque from both sides, and
/// the scene has others: it would hide what is behind holes, glass and backs.
void requireDrawable(Method method, const Scene& scene);

/// Computes the PVS of one cell by params.method on `device`, which holds `scene`: by default GVS++ (Koch and
/// Wimmer 2021; thesis, algorithms 5.1 and 6.1 to 6.4). cell_index numbers the cell in its bake: it enters
/// the random shifts only. The naive method is gvs++ on a device of makeNaiveDevice
/// (core/device/naive/naive_device.h), and an Error on any other. Throws Error, Interrupted.
CellPvs bakeCell(Device& device, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                 const BakeParams& params, const BakeHooks& hooks = {});

}  // namespace sightline
