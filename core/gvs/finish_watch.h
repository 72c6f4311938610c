#pragma once
#include <cstddef>
#include <vector>

namespace sightline {

/// Watches whether forecasts of the time left come true: one that is put off again and again is better given
/// as a range.
class FinishWatch {
 public:
  /// A forecast: after `seconds` of work, ascending, so many are left.
  void add(double seconds, double seconds_left) { forecasts_.push_back({seconds, seconds + seconds_left}); }

  /// Over the last quarter of the work the time left has not gone down by half of what has passed.
  bool standsStill() const {
    if (forecasts_.empty()) return false;
    const Forecast& last = forecasts_.back();
    size_t i = forecasts_.size() - 1;
    while (i > 0 && forecasts_[i].at > kSince * last.at) --i;
    return last.finish - forecasts_[i].finish > kMissed * (last.at - forecasts_[i].at);
  }

 private:
  static constexpr double kSince = 0.75, kMissed = 0.5;
  struct Forecast {
    double at, finish;
  };
  std::vector<Forecast> forecasts_;
};

}  // namespace sightline
