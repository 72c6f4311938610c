#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/measure/ranked_set.h"
#include "core/sampling/views.h"
#include "core/trace/tracer.h"

// The pixel error (S. Nirenstein and E. Blake 2004; thesis 7.1): images seen from the cell, in which a pixel
// is wrong if it shows a triangle that is not in the cell's set.
namespace sightline {

/// Views and their pixels. CPUs trace a hundredth of a GPU's rays, so their default looks less closely.
struct MeasureOptions {
  uint32_t views = 2000;       ///< 1 .. kMaxMeasureViews
  uint32_t resolution = 1000;  ///< pixels a side, 1 .. kMaxMeasureResolution
  uint64_t seed = 1;
  double fov = kDefaultFov;  ///< degrees, kSmallestFov .. kLargestFov
  uint32_t worst_views = 3;  ///< views to name, at most
};
inline constexpr uint32_t kMaxMeasureViews = 1'000'000, kMaxMeasureResolution = 4096;
inline constexpr uint32_t kViewsOnCpu = 200, kResolutionOnCpu = 250;

/// Error of one set, over all views.
struct PixelError {
  uint32_t views = 0;
  uint64_t pixels = 0;          ///< of all views, those that show nothing included
  uint64_t wrong = 0;           ///< of these pixels
  uint64_t regions = 0;         ///< of all views
  uint32_t max_wrong = 0;       ///< in one view
  uint32_t worst_view = 0;      ///< that view, the first of several
  uint32_t max_regions = 0;     ///< in one view
  uint32_t largest_region = 0;  ///< pixels

  double averageWrong() const { return views == 0 ? 0 : double(wrong) / views; }
  double averageRegions() const { return views == 0 ? 0 : double(regions) / views; }
  double wrongShare() const { return pixels == 0 ? 0 : double(wrong) / double(pixels); }
  bool operator==(const PixelError&) const = default;
};

/// Error of a ranked set.
struct SetError {
  std::vector<PixelError> by_prefix;  ///< one a prefix
  /// Views with the most wrong pixels of the last prefix, worst first (of equal ones the first); only such
  /// that have any.
  std::vector<uint32_t> worst_views;
};

/// Averages over cells, and the largest of all.
struct SceneError {
  double average_wrong = 0, average_regions = 0, wrong_share = 0;
  double mean_max_wrong = 0, mean_largest_region = 0;  ///< as table 7.2 of the thesis has them
  uint32_t max_wrong = 0, largest_region = 0;
};
SceneError summarize(std::span<const PixelError> cells);

struct MeasureProgress {
  uint32_t views_done = 0, views = 0;
  uint64_t rays = 0;
  double seconds = 0;  ///< since the cell's start
};
using MeasureCallback = std::function<void(const MeasureProgress&)>;

/// Measures any number of sets of one cell with the same views (measureViews), each of which is traced once.
/// cell_index: the cell's place in its file. The result depends on the device only where its hits do. Throws
/// Error, and Interrupted (core/gvs/bake_cell.h) when *stop became true.
std::vector<SetError> measureCell(Tracer& tracer, const ViewCell& cell, uint32_t cell_index,
                                  std::span<const RankedSet> sets, const MeasureOptions& options,
                                  const MeasureCallback& progress = {},
                                  const std::atomic<bool>* stop = nullptr);

/// Throws Error (wrong usage) that names the option that is out of range.
void checkOptions(const MeasureOptions& options);

}  // namespace sightline
