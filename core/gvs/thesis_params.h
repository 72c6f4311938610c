#pragma once
#include "core/pvs/bake_params.h"

namespace sightline {

/// Gives the parameters the thesis's values (tables 7.2 and 6.2.2): samples, distances in world units, order
/// of the rays, stop rule. Method, limits, batches, validation and seed stay.
///
/// The thesis names the discontinuity threshold Delta_RS (algorithm 6.2) without a value. Its published
/// program compares with 0.985 world units, in gvs++ and in gvs alike, and made the figures with it: so do
/// we. Distances in world units mean something else in a scene of another scale; our defaults are relative.
inline void setThesisParams(BakeParams& params) {
  params.n_rand = 10'000'000;
  params.n_abs_edge = params.n_rs_edge = params.n_rs_area = 20;
  params.abs_spacing = 0;
  params.reverse_stride = 1;
  params.order = Order::kQueue;
  params.delta_abs = 0.001f;
  params.delta_abs_relative = 0;
  params.delta_rs = 0.985f;
  params.delta_rs_relative = 0;
  params.threshold = 10;
  params.quiet_iterations = 1;
}

}  // namespace sightline
