#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sightline {

/// How many iterations a bake to a threshold still takes, if what they find goes on falling as 1 / iteration,
/// as the last triangles of large scenes do. For progress lines: may be off by a few times.
class IterationForecast {
 public:
  /// found: new triangles of the next complete iteration.
  void add(uint32_t found) { found_.push_back(found); }

  /// Iterations after the last one added until one finds fewer than threshold (at least 1), that one
  /// included; 0 if the last did. The first three, which find most, foretell nothing.
  double due(uint32_t threshold) const {
    if (!found_.empty() && found_.back() < threshold) return 0;
    if (found_.size() < 4) return 1;
    const double sum = std::accumulate(found_.end() - lastQuarter(), found_.end(), 0.0);
    const double latest = sum / double(lastQuarter());
    return std::max(1.0, double(found_.size()) * (latest / threshold - 1));
  }

 private:
  std::ptrdiff_t lastQuarter() const { return std::ptrdiff_t(found_.size() / 4); }

  std::vector<uint32_t> found_;
};

}  // namespace sightline
