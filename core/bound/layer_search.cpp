#include "core/bound/layer_search.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

// Layers between cell and box along each axis; none where low > high.
VoxelBox layersBetween(const RealBox& cell, const RealBox& box) {
  VoxelBox layers;
  for (int axis = 0; axis < 3; ++axis) {
    layers.low[axis] = 0;
    layers.high[axis] = -1;
    if (box.low[axis] > cell.high[axis]) {
      layers.low[axis] = int(std::ceil(cell.high[axis]));
      layers.high[axis] = int(std::floor(box.low[axis])) - 1;
    } else if (box.high[axis] < cell.low[axis]) {
      layers.low[axis] = int(std::ceil(box.high[axis]));
      layers.high[axis] = int(std::floor(cell.low[axis])) - 1;
    }
  }
  return layers;
}

}  // namespace

LayerSearch::LayerSearch(const CellHull& hull, double part_size, const VoxelBox& region, BlockedView& view)
    : region_(region), view_(view) {
  int cuts = 0;
  for (CellHull part = hull; part.longest() > part_size && cuts < kMostCuts; ++cuts) part = part.halves()[0];
  parts_.push_back({hull, {}});
  for (size_t i = 0; parts_.size() + 1 < size_t(2) << cuts; ++i) {
    for (const CellHull& half : parts_[i].hull.halves()) parts_.push_back({half, {}});
  }
}

bool LayerSearch::isCovered(Part& part, const RealBox& box, int axis, int at) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const PlaneRect rect = part.hull.crossing(box, axis, at + 0.5);
  VoxelBox layer;
  layer.low[axis] = layer.high[axis] = at;
  // No segment leaves the region: what of the rectangle does, does by rounding.
  layer.low[u] = std::max(int(std::floor(rect.low_u)), region_.low[u]);
  layer.high[u] = std::min(int(std::floor(rect.high_u)), region_.high[u]);
  layer.low[v] = std::max(int(std::floor(rect.low_v)), region_.low[v]);
  layer.high[v] = std::min(int(std::floor(rect.high_v)), region_.high[v]);
  if (!view_.covers(axis, layer)) return false;
  part.last = {axis, at};
  return true;
}

LayerSearch::Result LayerSearch::lookFrom(size_t index, const RealBox& box) {
  Part& part = parts_[index];
  const VoxelBox between = layersBetween(part.hull.box(), box);
  const int last_axis = std::max(part.last.axis, 0);
  if (part.last.axis >= 0 && part.last.at >= between.low[last_axis] &&
      part.last.at <= between.high[last_axis] && isCovered(part, box, last_axis, part.last.at))
    return Result::kHidden;

  // Along the segment from the box's middle to the cell's, which share is a place on it.
  const glm::dvec3 from = 0.5 * (box.low + box.high), way = part.hull.center() - from;
  const double length = std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
  const double nudge = 0.25 / length;  // to be past a side of a cube, in spite of rounding
  double run = -1;                     // where a blocked part began
  bool is_blocked = false;
  bool is_hidden = false;
  view_.visitAlong(from, way, nudge, [&](double share, bool blocked) {
    if (blocked && run < 0) run = share;
    is_blocked = is_blocked || blocked;
    if (!blocked && run >= 0) {
      is_hidden = tryRun(part, box, between, from, way, run, share);
      run = -1;
    }
    return !is_hidden;
  });
  if (is_hidden) return Result::kHidden;
  if (run >= 0 && tryRun(part, box, between, from, way, run, 1)) return Result::kHidden;
  if (!is_blocked) return Result::kFree;
  if (2 * index + 2 >= parts_.size()) return Result::kOpen;
  const Result half = lookFrom(2 * index + 1, box);
  return half == Result::kHidden ? lookFrom(2 * index + 2, box) : half;
}

// Some layers across the blocked part of the segment from `near` (the box) to `far` (the cell).
bool LayerSearch::tryRun(Part& part, const RealBox& box, const VoxelBox& between, const glm::dvec3& from,
                         const glm::dvec3& way, double near, double far) {
  constexpr double kShares[] = {0.5, 0.875, 0.125, 1, 0, 0.25, 0.75};
  for (int axis = 0; axis < 3; ++axis) {
    if (between.low[axis] > between.high[axis]) continue;
    int tried = INT32_MIN;
    for (const double share : kShares) {
      const double place = from[axis] + way[axis] * (near + (far - near) * share);
      const int at = std::clamp(int(std::floor(place)), between.low[axis], between.high[axis]);
      if (at == tried) continue;
      tried = at;
      if (isCovered(part, box, axis, at)) return true;
    }
  }
  return false;
}

}  // namespace sightline
