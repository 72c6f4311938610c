#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/pvs/missing_bound.h"
#include "core/pvs/pvs_file.h"

namespace sightline {

/// What tables and reports say about a baked cell: all but its ids and witnesses.
struct CellSummary {
  ViewCell cell;
  CellStats stats;
  uint32_t pvs_size = 0;                     ///< triangles in the set
  uint64_t set_hash = 0;                     ///< XXH3 of the ids
  std::string device;                        ///< that baked it
  std::optional<CellStats> open_stats = {};  ///< of a bake with doors
  uint32_t open_added = 0;                   ///< triangles that their opening adds
  uint64_t open_hash = 0;                    ///< XXH3 of their ids

  /// Traced by the three stages, validation left out.
  uint64_t rays() const { return stats.random.rays + stats.border.rays + stats.reverse.rays; }
  /// Million rays a second of the three stages; 0 if nothing was timed.
  double mraysPerSecond() const;
  double missingShare() const;
  double missingBound() const { return missingUpperBound(stats.missing_rays, stats.validation_rays); }
};

CellSummary summarize(const CellPvs& pvs);
std::vector<CellSummary> summarize(const PvsFile& pvs);

/// XXH3 of all sets: equal for two bakes that found the same, whatever the device and the time they took.
uint64_t hashResult(std::span<const CellSummary> cells);

/// "converged", "ray limit", "time limit" or "target error".
std::string stopReasonName(StopReason reason);

}  // namespace sightline
