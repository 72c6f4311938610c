#pragma once
#include <cstdint>

#include "core/pvs/cell_stats.h"

namespace sightline {

/// Where a cell's bake stands. The list is that of its set's triangles, in the order in which they were
/// found.
struct CellState {
  CellStats stats;
  uint64_t rays = 0;             ///< of the three stages
  uint32_t random_left = 0;      ///< random rays of this iteration still to trace
  uint32_t pvs_size = 0;         ///< entries of the list
  uint32_t bordered = 0;         ///< entries of the list whose border rays have been traced
  uint32_t listed = 0;           ///< entries whose discontinuities have been listed; fewer once the list of
                                 ///< discontinuities was full
  uint32_t discontinuities = 0;  ///< that the device has listed ...
  uint32_t reversed = 0;         ///< ... and whose reverse rays have been traced
  uint64_t discontinuities_total = 0;  ///< of the cell
  uint32_t iteration_new = 0;          ///< triangles that this iteration has found
  uint64_t test_left = 0;              ///< rays of the test of the error in work
  bool testing = false, validating = false;

  /// Discontinuities whose reverse rays are still to be traced.
  uint32_t waiting() const { return discontinuities - reversed; }
};

}  // namespace sightline
