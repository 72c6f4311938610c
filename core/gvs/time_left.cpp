#include "core/gvs/time_left.h"

#include <algorithm>

namespace sightline {
namespace {

/// Where the time left is given as a range: the probability that the bake ends before it, and after it.
constexpr double kEarlyChance = 0.1;

}  // namespace

void TimeLeft::add(const CellState& state, double took, double seconds) {
  forecast_.add(state.iteration_new, took);
  finish_.add(seconds, convergence(state, double(state.rays) / seconds));
}

void TimeLeft::estimate(const CellState& state, BakeProgress& p) const {
  const double rays_a_second = double(p.rays) / p.seconds;
  if (state.validating) {
    p.seconds_left = double(params_.validation_rays - state.stats.validation_rays) / rays_a_second;
    return;
  }
  const bool limited = params_.max_seconds > 0 || params_.max_rays > 0;
  const bool endless = params_.threshold == 0 || params_.target_error > 0;
  double left = limited ? 1e18 : -1;
  if (params_.max_seconds > 0) left = params_.max_seconds - p.seconds;
  if (params_.max_rays > 0) {
    left = std::min(left, (double(params_.max_rays) - double(state.rays)) / rays_a_second);
  }
  if (limited) left = std::max(left, 0.0) + double(params_.validation_rays) / rays_a_second;
  p.seconds_left = left;
  if (endless && !state.testing) return;
  // A test: rays until the cell is done, if it passes.
  const double test_rays = double(state.test_left + params_.validation_rays);
  const double estimate = state.testing ? test_rays / rays_a_second : convergence(state, rays_a_second);
  if (limited && left <= estimate) return;
  p.seconds_left = estimate;
  if (state.testing) return;
  p.at_least = !forecast_.foretells(params_.threshold);
  if (p.at_least || !finish_.standsStill()) return;
  p.seconds_left_from = convergence(state, rays_a_second, kEarlyChance);
  p.seconds_left_to = convergence(state, rays_a_second, 1 - kEarlyChance);
  if (limited) p.seconds_left_to = std::min(p.seconds_left_to, left);
}

/// Estimate of the seconds until T ends the cell, if the queue grows no further: in so many that it has with
/// probability `chance`.
double TimeLeft::convergence(const CellState& state, double rays_a_second, double chance) const {
  const double explored = std::max(1.0, double(state.bordered));
  const double border_each = double(state.stats.border.rays) / explored;
  const double waiting_each = double(state.discontinuities_total) / explored;
  const double entries = double(state.pvs_size - state.listed);
  const double rays = double(state.waiting()) * reverse_each_ +
                      entries * (border_each + waiting_each * reverse_each_) +
                      double(params_.validation_rays);
  const double iterations = iterationsDue(state, chance) + double(state.random_left) / params_.n_rand;
  const double each = state.stats.iterations > 1 ? forecast_.secondsEach(params_.threshold)
                                                 : double(params_.n_rand) / rays_a_second;
  return iterations * each + rays / rays_a_second;
}

/// Estimate of the iterations after this one.
double TimeLeft::iterationsDue(const CellState& state, double chance) const {
  const double next = state.iteration_new >= params_.threshold ? 1 : 0;
  return std::max(next, forecast_.due(params_.threshold, chance) - 1) + params_.quiet_iterations - 1;
}

}  // namespace sightline
