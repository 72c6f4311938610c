#pragma once
#include <span>
#include <vector>

#include "core/page/html_report.h"

namespace sightline {

/// What many curves have in common: at each x the median of their values, the lowest and the highest.
struct CurveRange {
  std::vector<ChartPoint> median, lowest, highest;  ///< at the same x
};

/// Which axes of a chart are logarithmic.
struct ChartAxes {
  bool log_x = false, log_y = false;
};

/// The range of curves of ascending x, from where the last of them begins to where the last ends, at their
/// own x, at most `most` (2 or more) of them, evenly along the axis. A curve is the straight line between its
/// points that a chart of these axes draws, and after its end goes on level. The median of an even number is
/// the mean of the middle two. Empty curves, points that are not finite and, on a logarithmic axis, points at
/// x of 0 or below do not count; without any other the range is empty.
CurveRange rangeOf(std::span<const std::vector<ChartPoint>> curves, ChartAxes axes,
                   size_t most = kMaxChartPoints);

}  // namespace sightline
