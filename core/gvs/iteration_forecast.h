#pragma once
#include <cstdint>
#include <vector>

namespace sightline {

/// How many iterations a bake to a threshold still takes, and how long they last, if what they find goes on
/// falling as a power of their number, as the last triangles of scenes do. For progress lines: may be off by
/// two times or so.
class IterationForecast {
 public:
  /// An iteration is complete: its new triangles, and the seconds that it took.
  void add(uint32_t found, double seconds);

  /// Iterations after the last one added until one finds fewer than threshold (at least 1), that one
  /// included: so many that it has come with probability `chance` (below 1). 0 if the last one added did; 1
  /// as long as they foretell nothing.
  double due(uint32_t threshold, double chance = 0.5) const;

  /// What has been added so far says only that another iteration is due: the first three are too few, and an
  /// early one that found very much is no part of the fall yet.
  bool foretells(uint32_t threshold) const;

  /// Of an iteration to come, by the last quarter of them, two at least, and not by the first where there is
  /// another; as long as they foretell nothing, of the shortest. 0 before the first.
  double secondsEach(uint32_t threshold) const;

 private:
  std::vector<uint32_t> found_;
  std::vector<double> seconds_;
};

}  // namespace sightline
