#pragma once
#include "core/gvs/bake_progress.h"
#include "core/gvs/cell_state.h"
#include "core/gvs/finish_watch.h"
#include "core/gvs/iteration_forecast.h"
#include "core/pvs/bake_params.h"

namespace sightline {

/// Estimates the seconds until a cell is done: to its limits, or less where T may end it.
class TimeLeft {
 public:
  /// reverse_each: reverse rays of a discontinuity. params must live as long.
  TimeLeft(const BakeParams& params, uint32_t reverse_each)
      : params_(params), reverse_each_(double(reverse_each)) {}

  /// An iteration is complete: it took so many of the seconds since the cell's start.
  void add(const CellState& state, double took, double seconds);

  /// Fills in the fields that begin with seconds_left, and at_least, by p.rays and p.seconds. Negative:
  /// nobody knows.
  void estimate(const CellState& state, BakeProgress& p) const;

 private:
  double convergence(const CellState& state, double rays_a_second, double chance = 0.5) const;
  double iterationsDue(const CellState& state, double chance) const;

  const BakeParams& params_;
  double reverse_each_;
  IterationForecast forecast_;  ///< of the iterations before this one
  FinishWatch finish_;          ///< of convergence() after each iteration
};

}  // namespace sightline
