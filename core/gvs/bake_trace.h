#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace sightline {

/// Where a cell's bake stood after one of its batches. Counts are totals since the cell's start.
struct CurvePoint {
  double seconds = 0;                       ///< since the cell's start
  std::array<uint64_t, 3> rays{};           ///< random, border, reverse (kStage...)
  std::array<uint64_t, 3> new_triangles{};  ///< as rays
  uint32_t size = 0;                        ///< triangles in the set: the first of BakeTrace::order
  uint32_t iteration = 0;                   ///< 1, 2, ...

  /// Of the three stages.
  uint64_t allRays() const { return rays[0] + rays[1] + rays[2]; }
  bool operator==(const CurvePoint&) const = default;
};

/// How a cell's set grew: the set at a point of the curve is the first `size` triangles of the order.
struct BakeTrace {
  std::vector<CurvePoint> curve;  ///< one point a batch, in order
  std::vector<uint32_t> order;  ///< triangles in order of discovery; those that only meet the cell come last
};

}  // namespace sightline
