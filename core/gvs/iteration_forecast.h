#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sightline {

/// How many iterations a bake to a threshold still takes, by how fast they find less. Random rays find the
/// last triangles as 1 / iteration or so; the power is taken from two windows of the past, the latter of
/// twice the iterations of the former. For progress lines: good to a factor of three.
class IterationForecast {
 public:
  /// found: new triangles of the next complete iteration.
  void add(uint32_t found) { found_.push_back(found); }

  /// Iterations after the last one added until one finds fewer than threshold (at least 1), that one
  /// included; 0 if the last did.
  double due(uint32_t threshold) const {
    const size_t n = found_.size();
    if (n > 0 && found_.back() < threshold) return 0;
    if (n < 4) return 1;
    const double count = double(n);
    const double former = mean(n / 4, n / 2), latter = mean(n / 2, n);
    if (latter <= threshold) return 1;
    const double power = former > latter ? std::clamp(std::log2(former / latter), 0.5, 4.0) : 0.5;
    return std::max(1.0, 0.75 * count * std::pow(latter / threshold, 1 / power) - count);
  }

 private:
  double mean(size_t first, size_t last) const {
    return std::accumulate(found_.begin() + first, found_.begin() + last, 0.0) / double(last - first);
  }

  std::vector<uint32_t> found_;
};

}  // namespace sightline
