#include "core/page/curve_range.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

using Points = std::vector<ChartPoint>;

Points countable(const Points& curve, bool log_x) {
  Points points;
  std::copy_if(curve.begin(), curve.end(), std::back_inserter(points),
               [&](ChartPoint p) { return std::isfinite(p.x) && std::isfinite(p.y) && (!log_x || p.x > 0); });
  return points;
}

/// x must not be before the curve.
double valueAt(const Points& curve, double x, ChartAxes axes) {
  const auto after =
      std::upper_bound(curve.begin(), curve.end(), x, [](double at, ChartPoint p) { return at < p.x; });
  const ChartPoint a = *std::prev(after);
  if (after == curve.end() || a.x == x) return a.y;
  const ChartPoint b = *after;
  const double share = axes.log_x ? std::log(x / a.x) / std::log(b.x / a.x) : (x - a.x) / (b.x - a.x);
  if (axes.log_y && a.y > 0 && b.y > 0) return a.y * std::pow(b.y / a.y, share);
  return std::lerp(a.y, b.y, share);
}

/// All x of the curves from `begin` on, ascending, as points without a value.
Points placesFrom(double begin, const std::vector<Points>& curves) {
  Points places;
  for (const Points& curve : curves) {
    for (const ChartPoint& p : curve) {
      if (p.x >= begin) places.push_back({p.x, 0});
    }
  }
  places.push_back({begin, 0});
  std::ranges::sort(places, {}, &ChartPoint::x);
  const auto same = [](const ChartPoint& a, const ChartPoint& b) { return a.x == b.x; };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
  return places;
}

}  // namespace

CurveRange rangeOf(std::span<const std::vector<ChartPoint>> curves, ChartAxes axes, size_t most) {
  std::vector<Points> counted;
  for (const Points& curve : curves) {
    Points points = countable(curve, axes.log_x);
    if (!points.empty()) counted.push_back(std::move(points));
  }
  CurveRange range;
  if (counted.empty()) return range;
  double begin = counted.front().front().x;
  for (const Points& curve : counted) begin = std::max(begin, curve.front().x);
  std::vector<double> values(counted.size());
  for (const ChartPoint& place : thinned(placesFrom(begin, counted), axes.log_x, most)) {
    std::ranges::transform(counted, values.begin(),
                           [&](const Points& c) { return valueAt(c, place.x, axes); });
    std::ranges::sort(values);
    const size_t middle = values.size() / 2;
    const double median = values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
    range.median.push_back({place.x, median});
    range.lowest.push_back({place.x, values.front()});
    range.highest.push_back({place.x, values.back()});
  }
  return range;
}

}  // namespace sightline
