#pragma once
#include <algorithm>
#include <cstdint>

#include "core/pvs/bake_params.h"
#include "core/pvs/cell_stats.h"

namespace sightline {

/// Rays a second of border or reverse rays, whichever are slower; before the first, a tenth of the random
/// rays', as in a thicket. A stage whose clock has not moved counts as one tick of it: its rate is high, but
/// a number.
inline double slowestRate(const CellStats& stats) {
  constexpr double kTick = 1e-9;
  const auto rate = [&](const StageStats& stage) {
    return double(stage.rays) / std::max(stage.seconds, kTick);
  };
  double slowest = rate(stats.random) / 10;
  if (stats.border.rays > 0) slowest = rate(stats.border);
  if (stats.reverse.rays > 0) slowest = std::min(slowest, rate(stats.reverse));
  return slowest;
}

/// Rays of a border or reverse batch that are likely to end within the seconds left: kFewestBatchRays at
/// least, `most` at most, which is no less.
inline uint32_t raysInTime(const CellStats& stats, double seconds_left, uint64_t most) {
  const double in_time = slowestRate(stats) * std::max(0.0, seconds_left);
  return static_cast<uint32_t>(std::clamp(in_time, double(kFewestBatchRays), double(most)));
}

}  // namespace sightline
