// Based on: C. Clopper and E. Pearson 1934 (the bound of one test); alpha spending over repeated looks after
// K. Lan and D. DeMets, "Discrete sequential boundaries for clinical trials", Biometrika 1983, by the union
// bound, since each test has rays of its own.
#include "core/gvs/error_bound.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "core/base/splitmix.h"
#include "core/pvs/missing_bound.h"

namespace sightline {
namespace {

constexpr double kConfidence = 0.95;
/// Keeps the rays apart from those of the bake and from the views of measure with the same seed.
constexpr uint64_t kBoundKey = 0x626f756e64;  // "bound"
/// Random numbers a ray: four for the view, two for the pixel.
constexpr uint64_t kNumbers = 6;
/// Rays of the first launch of a test, and of each at most: a test that fails soon costs little.
constexpr uint64_t kFirstLaunch = 1u << 14, kLargestLaunch = 1u << 20;

}  // namespace

ErrorBound::ErrorBound(const ViewCell& cell, uint32_t cell_index, uint64_t seed, double target)
    : views_(cell), key_(splitmix(splitmix(splitmix(seed) ^ cell_index) ^ kBoundKey)), target_(target) {}

double ErrorBound::alpha(uint32_t k) {
  const double step = std::numbers::pi * k;
  return (1 - kConfidence) * 6 / (step * step);
}

uint64_t ErrorBound::raysOfTest(uint32_t k, double target) {
  return raysForBound(kAllowedMisses, target, alpha(k));
}

Ray ErrorBound::ray(uint64_t index) const {
  std::array<double, kNumbers> numbers;
  for (uint64_t i = 0; i < kNumbers; ++i) {  // of one splitmix64 sequence, by their place in it
    const uint64_t bits = mixBits(key_ + (index * kNumbers + i + 1) * kSplitmixStep);
    numbers[i] = double(bits >> 11) * 0x1p-53;
  }
  const ViewFrame frame = views_.at({numbers[0], numbers[1], numbers[2], numbers[3]});
  return viewRay(frame, uint32_t(numbers[4] * kResolution), uint32_t(numbers[5] * kResolution), kResolution);
}

void ErrorBound::makeRays(std::vector<Ray>& rays, uint64_t first, uint64_t count) const {
  rays.resize(count);
  tbb::parallel_for(uint64_t(0), count, [&](uint64_t i) { rays[i] = ray(first + i); });
}

bool ErrorBound::test(const Trace& trace, std::span<const uint8_t> member,
                      const std::function<bool(uint64_t)>& between, uint64_t most) {
  const uint64_t wanted = raysOfTest(++tests_, target_), due = std::min(wanted, most);
  uint64_t traced = 0, missed = 0;
  uint64_t launch = kFirstLaunch;
  makeRays(batch_, rays_, std::min(launch, due));
  while (traced < due && missed <= kAllowedMisses) {
    hits_.resize(batch_.size());
    traced += batch_.size();
    rays_ += batch_.size();
    launch = std::min(2 * launch, kLargestLaunch);
    // The next rays are made while the device traces these.
    tbb::task_group making;
    making.run([&, count = std::min(launch, due - traced)] { makeRays(next_batch_, rays_, count); });
    try {
      trace(batch_, hits_);
    } catch (...) {
      making.wait();
      throw;
    }
    making.wait();
    std::swap(batch_, next_batch_);
    for (const Hit& hit : hits_) missed += hit.triangle != kNoTriangle && member[hit.triangle] == 0;
    if (between && !between(due - traced)) break;
  }
  // Ending early does not spoil the bound: it takes more misses than are allowed, so whoever would be wrong
  // about a share at that end would have been wrong at the first launch after which the bound of nine misses
  // is below that share, too: one event, of probability alpha at most. Where `between` or `most` ends it, no
  // miss has a say in that.
  bound_ = std::min(bound_, missingUpperBound(missed, traced, alpha(tests_)));
  return traced == wanted && missed <= kAllowedMisses;
}

}  // namespace sightline
