#pragma once
#include <cstdint>

namespace sightline {

/// Counts of one stage of one cell.
struct StageStats {
  uint64_t rays = 0;           ///< traced
  uint64_t new_triangles = 0;  ///< that this stage found
  double seconds = 0;
};

/// Why a cell's bake ended.
enum class StopReason : uint32_t { kConverged = 0, kRayLimit = 1, kTimeLimit = 2, kTargetError = 3 };

/// What a cell's bake did.
struct CellStats {
  StageStats random, border, reverse;
  uint64_t contained_triangles = 0;  ///< in the set only because they meet the cell itself
  uint32_t iterations = 0;
  StopReason stop = StopReason::kConverged;
  uint64_t validation_rays = 0;  ///< fresh random rays
  uint64_t missing_rays = 0;     ///< of them: hit a triangle outside the set
  uint64_t bound_rays = 0;       ///< fresh rays of random pixels that tested the error (target_error)
  uint32_t bound_tests = 0;      ///< in so many tests
  double error_bound = 1;        ///< upper bound of the share of wrong pixels, 95 % confidence; 1: not tested
  double seconds = 0;            ///< whole cell, validation included
  uint64_t peak_device_bytes = 0;
};

}  // namespace sightline
