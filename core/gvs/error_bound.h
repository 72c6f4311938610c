#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/sampling/views.h"

namespace sightline {

/// Holds a bake to the promise of --target-error: with 95 % confidence, the share of wrong pixels that
/// `sightline measure` would find over all views of the cell is below the target.
///
/// A test traces fresh rays, each the ray of a random pixel of a random view (uniform over all views of
/// CellViews with the default field of view): independent of each other, of all earlier ones and of the bake.
/// Test k may err with probability alpha_k = 0.05 * 6 / (pi k)^2, which over all tests adds up to 5 %: so the
/// promise holds however often a bake is tested before it passes. The upper bound of the share is that of
/// Clopper and Pearson at alpha_k.
///
/// A test's number of rays follows from target and alpha_k alone: with it, kAllowedMisses wrong pixels just
/// pass, so that a cell whose true share is a third of the target passes nine times in ten. A test ends early
/// when it has failed.
class ErrorBound {
 public:
  /// Nearest hits of rays, as Tracer::traceRays.
  using Trace = std::function<void(std::span<const Ray> rays, std::span<Hit> hits)>;

  static constexpr uint32_t kAllowedMisses = 8;
  /// Pixels a side of the images that the rays' pixels are of: measure's default.
  static constexpr uint32_t kResolution = 1000;

  /// target: above 0, below 1. cell_index and seed choose the rays, as they do those of a bake.
  ErrorBound(const ViewCell& cell, uint32_t cell_index, uint64_t seed, double target);

  /// One more test of a set: member has a byte a triangle of the scene, not 0 for those in the set. The set
  /// may only have grown since the last test. True: the bound is below the target. between(left): after every
  /// launch, with the rays that are left of this test; false ends it; it may throw. most: of the test's rays,
  /// where there is no time for all. A test that is not whole gives a bound, but does not pass.
  bool test(const Trace& trace, std::span<const uint8_t> member,
            const std::function<bool(uint64_t)>& between = {}, uint64_t most = ~uint64_t(0));

  /// The share of wrong pixels is below this with 95 % confidence: the best of all tests. 1 before the first.
  double bound() const { return bound_; }
  uint64_t rays() const { return rays_; }
  uint32_t tests() const { return tests_; }

  /// What test number k = 1, 2, ... may err with, and the rays that it takes at most.
  static double alpha(uint32_t k);
  static uint64_t raysOfTest(uint32_t k, double target);

 private:
  Ray ray(uint64_t index) const;
  void makeRays(std::vector<Ray>& rays, uint64_t first, uint64_t count) const;

  CellViews views_;
  uint64_t key_;
  double target_;
  double bound_ = 1;
  uint64_t rays_ = 0;  ///< also the index of the next ray: none comes twice
  uint32_t tests_ = 0;
  std::vector<Ray> batch_, next_batch_;
  std::vector<Hit> hits_;
};

}  // namespace sightline
