#pragma once
#include <cstdint>

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

}  // namespace sightline
