#include "core/gvs/stop_rule.h"

#include <algorithm>

namespace sightline {
namespace {

/// After a test of the error, so many times its rays are traced before the next one: tests take a fifth of
/// all rays at most. Those that fail soon, while the error is large, hold up nothing.
constexpr uint64_t kRaysBetweenTests = 4;

}  // namespace

StopRule::StopRule(const BakeParams& params)
    : max_rays_(params.max_rays),
      max_seconds_(params.max_seconds),
      threshold_(params.threshold),
      quiet_iterations_(params.quiet_iterations),
      by_target_(params.target_error > 0) {}

bool StopRule::afterLaunch(uint64_t rays, double seconds) {
  if (max_rays_ > 0 && rays >= max_rays_) reason_ = StopReason::kRayLimit;
  if (timeIsUp(seconds)) reason_ = StopReason::kTimeLimit;
  return unlimited();
}

bool StopRule::endsAfter(uint32_t new_triangles) {
  quiet_ = new_triangles < threshold_ ? quiet_ + 1 : 0;
  return !unlimited() || (!by_target_ && quiet_ >= quiet_iterations_);
}

bool StopRule::testDue(uint64_t rays) const {
  return by_target_ && (rays >= next_test_ || !unlimited());
}

uint64_t StopRule::mostTestRays(uint64_t rays) const {
  const uint64_t brief = rays / kRaysBetweenTests + 1;
  if (!unlimited()) return brief;
  return max_rays_ == 0 ? ~uint64_t(0) : std::max(brief, max_rays_ - rays);
}

bool StopRule::afterTestLaunch(double seconds) {
  if (unlimited() && timeIsUp(seconds)) {
    reason_ = StopReason::kTimeLimit;
    return false;
  }
  return true;
}

bool StopRule::afterTest(bool reached, uint64_t rays, uint64_t test_rays) {
  next_test_ = rays + kRaysBetweenTests * test_rays;
  if (reached) reason_ = StopReason::kTargetError;
  return !unlimited();
}

}  // namespace sightline
