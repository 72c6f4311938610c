#pragma once
#include <atomic>
#include <exception>
#include <functional>

#include "core/device/device.h"
#include "core/gvs/bake_trace.h"
#include "core/pvs/pvs.h"
#include "core/scene/scene.h"

namespace sightline {

/// State of a cell's bake, reported after every device launch: about once a second on a
/// processor, every few seconds where its rays are slowest.
struct BakeProgress {
  uint32_t iteration = 0;  ///< 1, 2, ...
  uint32_t stage = 0;      ///< kStage... in work; validation: kStageRandom with validating = true
  bool testing = false;    ///< in a test of --target-error
  bool validating = false;
  uint64_t rays = 0;  ///< traced so far, validation included
  uint64_t pvs_size = 0;
  uint64_t new_triangles = 0;  ///< in this iteration so far
  uint64_t queued = 0;         ///< entries still to explore
  double seconds = 0;          ///< since the cell's start
  double seconds_left = 0;     ///< estimate for this cell: to T (as many iterations as IterationForecast
                            ///< expects, queued entries, validation), or the way to its limits. Negative: not
                            ///< known, as before the first border rays
  bool at_least = false;  ///< it is no more than a lower bound: the iterations foretell nothing yet
  double seconds_left_from = 0, seconds_left_to = 0;  ///< where estimates have been put off again and again:
                                                      ///< in four of five cases it is between; else 0
};

/// Told about the bake; called on the caller's thread.
using ProgressCallback = std::function<void(const BakeProgress&)>;

/// What bakeCell may be asked for besides the set; nothing but most_listed changes the set.
struct BakeHooks {
  ProgressCallback progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends the bake with Interrupted when it becomes true
  BakeTrace* trace = nullptr;               ///< is replaced by how the set grew
  uint32_t most_listed = 1u << 25;  ///< discontinuities that may wait (16 bytes each on the device) before no
                                    ///< more are listed; for tests: another bound may change the set
};

/// Thrown by bakeCell when *stop became true: nothing of the cell is kept.
struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

/// Throws Error (wrong usage) that names the parameter that is out of range.
void checkParams(const BakeParams& params);

/// Throws Error (wrong usage) if no device of that name (of makeDevice) could run the method: raster needs
/// Vulkan.
void requireMethodOn(Method method, const std::string& device);

/// Computes the PVS of one cell by params.method on `device`, which holds `scene`: by default GVS++ (Koch and
/// Wimmer 2021; thesis, algorithms 5.1 and 6.1 to 6.4). cell_index numbers the cell in its bake: it enters
/// the random shifts only. The naive method is gvs++ on a device of makeNaiveDevice
/// (core/device/naive_device.h), and an Error on any other. Throws Error, Interrupted.
CellPvs bakeCell(Device& device, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                 const BakeParams& params, const BakeHooks& hooks = {});

}  // namespace sightline
