#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace sightline {

/// Counts errors by size, a quarter of an octave a bucket, so that percentiles of any number of them take no
/// more memory.
class ErrorHistogram {
 public:
  void add(double error) {
    ++buckets_[bucketOf(error)];
    ++count_;
    max_ = std::max(max_, error);
  }
  uint64_t count() const { return count_; }
  double max() const { return max_; }

  /// An error that the given share of them do not exceed, at most a quarter of an octave above the smallest
  /// such; 0 without any.
  double percentile(double share) const {
    const auto wanted = uint64_t(std::ceil(share * double(count_)));
    uint64_t seen = 0;
    for (size_t i = 0; i < kBuckets; ++i) {
      seen += buckets_[i];
      if (seen >= wanted && seen > 0) return std::min(max_, std::exp2(double(i) / 4 - kOctavesBelowOne));
    }
    return max_;
  }

 private:
  static constexpr int kOctavesBelowOne = 6, kOctaves = 64;
  static constexpr size_t kBuckets = 4 * kOctaves;

  /// The first whose upper end, 2^(i / 4 - 6), is not below the error.
  static size_t bucketOf(double error) {
    if (!(error > 0)) return 0;
    const double place = std::ceil(4 * (std::log2(error) + kOctavesBelowOne));
    return size_t(std::clamp(place, 0.0, double(kBuckets - 1)));
  }

  std::array<uint64_t, kBuckets> buckets_{};
  uint64_t count_ = 0;
  double max_ = 0;
};

}  // namespace sightline
