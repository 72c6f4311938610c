#pragma once
#include <cstdint>

#include "core/pvs/bake_params.h"
#include "core/pvs/cell_stats.h"

namespace sightline {

/// When a cell's bake ends: at a limit of rays or of time, after as many quiet iterations as the threshold
/// wants, or, with a target error in the threshold's stead, when a test has shown it. Told of counts and
/// seconds alone, it knows no device and no clock.
///
/// After each launch comes afterLaunch, after each iteration endsAfter or, with a target error, testDue and
/// perhaps a test (mostTestRays, afterTestLaunch, afterTest). Rays are those of the three stages since the
/// cell's start, seconds too.
class StopRule {
 public:
  explicit StopRule(const BakeParams& params);

  /// kConverged as long as the bake goes on, too.
  StopReason reason() const { return reason_; }
  /// Nothing has ended the bake but, perhaps, the threshold.
  bool unlimited() const { return reason_ == StopReason::kConverged; }

  /// A launch of one of the stages has ended. false: a limit was reached.
  bool afterLaunch(uint64_t rays, double seconds);

  /// An iteration of the sampling has ended that found so many new triangles. Whether the bake ends: at a
  /// limit, or by the threshold where there is no target error.
  bool endsAfter(uint32_t new_triangles);

  /// Whether the error is to be tested now, after an iteration: where enough has been traced since the last
  /// test, and after a limit.
  bool testDue(uint64_t rays) const;
  /// Rays that a test begun now may take at most. After a limit it is brief, to say where the error stands;
  /// before, the limits end it.
  uint64_t mostTestRays(uint64_t rays) const;
  /// A launch of the test has ended. false: so has the test.
  bool afterTestLaunch(double seconds);
  /// The test has ended, which took so many rays. Whether the bake ends.
  bool afterTest(bool reached, uint64_t rays, uint64_t test_rays);

 private:
  bool timeIsUp(double seconds) const { return max_seconds_ > 0 && seconds >= max_seconds_; }

  uint64_t max_rays_;
  double max_seconds_;
  uint32_t threshold_, quiet_iterations_;
  bool by_target_;
  StopReason reason_ = StopReason::kConverged;
  uint32_t quiet_ = 0;      ///< iterations one after the other that found fewer than the threshold
  uint64_t next_test_ = 0;  ///< rays traced when the error is next tested
};

}  // namespace sightline
