#pragma once
#include <atomic>
#include <cstdint>
#include <functional>

#include "core/gvs/bake_progress.h"
#include "core/gvs/bake_trace.h"
#include "core/gvs/leaks.h"
#include "core/pvs/pvs_file.h"

namespace sightline {

/// Told about a bake of many cells, on the thread that bakes; any of them may be empty. index: of the cell
/// among those planned. What they throw ends the bake.
struct BakeEvents {
  /// About once a second, and every few seconds where rays are slowest.
  std::function<void(uint32_t index, const BakeProgress&)> progress;
  /// The cell is baked and, where the bake goes into a file, on the disk.
  std::function<void(uint32_t index, const CellPvs&)> cell_done;
  /// How the cell's set grew, before cell_done; empty: it is not recorded.
  std::function<void(uint32_t index, BakeTrace)> grown;
  /// What of the cell's set was only seen through narrow gaps, before cell_done; empty: it is not looked for.
  /// Nor is it with a smallest hole.
  std::function<void(uint32_t index, const Leaks&)> leaks;
  /// Ends the bake when another thread or a signal makes it true: the cell in work is lost, those before it
  /// are kept.
  const std::atomic<bool>* stop = nullptr;
};

}  // namespace sightline
