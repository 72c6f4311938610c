#include "core/place/clear_box.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/scene/box_triangle.h"
#include "core/scene/leaves_in_box.h"

namespace sightline {
namespace {

/// A side that has come in to the margin must not be too near by rounding: nearer than this share of it is.
constexpr double kTooNear = 1 - 0x1p-10;
/// Of a cell's smallest extent.
constexpr double kMarginShare = 0.01, kLargestMarginShare = 0.125;
/// Of a coordinate: floats are at most so far apart there.
constexpr double kSpacing = 0x1p-23;

/// A box along the axes, those of the world or of the cell.
struct Box {
  glm::dvec3 low, high;
};

Box grown(const Box& box, const glm::dvec3& by) {
  return {box.low - by, box.high + by};
}

/// Bounds in the world of a local box.
Box worldBounds(const CellFrame& frame, const Box& box) {
  const glm::dvec3 middle = frame.toWorld((box.low + box.high) * 0.5), half = (box.high - box.low) * 0.5;
  const glm::dvec3 reach =
      glm::abs(frame.axes[0]) * half.x + glm::abs(frame.axes[1]) * half.y + glm::abs(frame.axes[2]) * half.z;
  return {middle - reach, middle + reach};
}

struct LocalTriangle {
  glm::dvec3 corners[3];
};

LocalTriangle localTriangle(const Scene& scene, const CellFrame& frame, uint32_t id) {
  const auto t = scene.corners(id);
  return {
      {frame.toLocal(glm::dvec3(t[0])), frame.toLocal(glm::dvec3(t[1])), frame.toLocal(glm::dvec3(t[2]))}};
}

bool meets(const LocalTriangle& triangle, const Box& box) {
  const glm::dvec3 middle = (box.low + box.high) * 0.5;
  const glm::dvec3 corners[3] = {triangle.corners[0] - middle, triangle.corners[1] - middle,
                                 triangle.corners[2] - middle};
  return triangleMeetsBox(corners, (box.high - box.low) * 0.5);
}

/// Based on: I. Sutherland and G. Hodgman, Reentrant Polygon Clipping, 1974: the part of a convex polygon
/// with sign * p[axis] <= bound.
std::vector<glm::dvec3> clipped(const std::vector<glm::dvec3>& polygon, int axis, double sign, double bound) {
  std::vector<glm::dvec3> result;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double from = sign * a[axis] - bound, to = sign * b[axis] - bound;
    if (from <= 0) result.push_back(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) result.push_back(a + (b - a) * (from / (from - to)));
  }
  return result;
}

/// Bounds of the triangle's part in the box; nothing if it has none, or only by rounding.
std::optional<Box> partInside(const LocalTriangle& triangle, const Box& box) {
  std::vector<glm::dvec3> polygon(triangle.corners, triangle.corners + 3);
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clipped(polygon, axis, 1, box.high[axis]);
    polygon = clipped(polygon, axis, -1, -box.low[axis]);
  }
  if (polygon.empty()) return std::nullopt;
  Box part{polygon[0], polygon[0]};
  for (const glm::dvec3& p : polygon) part = {glm::min(part.low, p), glm::max(part.high, p)};
  return part;
}

/// A side of the box, and how far it must come in to clear a triangle.
struct Move {
  int axis = 0;
  bool high = false;
  double distance = HUGE_VAL;  ///< infinite: none of them may come in so far
};

/// The side that clears `part` of a triangle with the least to go.
Move leastMove(const Box& box, const Box& part, const SideInsets& insets, double margin,
               const glm::dvec3& limit) {
  Move best;
  for (int axis = 0; axis < 3; ++axis) {
    const double from_low = part.high[axis] + margin - box.low[axis];
    const double from_high = box.high[axis] - part.low[axis] + margin;
    if (from_low < best.distance && insets.low[axis] + from_low <= limit[axis]) {
      best = {axis, false, from_low};
    }
    if (from_high < best.distance && insets.high[axis] + from_high <= limit[axis]) {
      best = {axis, true, from_high};
    }
  }
  return best;
}

/// A triangle near the box, with what it takes to clear it alone.
struct Near {
  double distance;
  uint32_t id;
};

}  // namespace

std::optional<SideInsets> insetsToClear(const Scene& scene, const Bvh& bvh, const CellFrame& frame,
                                        double margin, const glm::dvec3& limit) {
  const Box whole{-frame.half_size, frame.half_size};
  const glm::dvec3 near(margin * kTooNear);
  SideInsets insets;
  // What the box keeps in any case must be free. Most boxes end here, at the first triangle.
  const Box core = grown(whole, near - limit);
  const Box core_bounds = worldBounds(frame, core);
  if (anyInLeaves(bvh, core_bounds.low, core_bounds.high,
                  [&](uint32_t id) { return meets(localTriangle(scene, frame, id), core); })) {
    return std::nullopt;
  }
  std::vector<Near> found;
  const Box around = grown(whole, near);
  const Box bounds = worldBounds(frame, around);
  anyInLeaves(bvh, bounds.low, bounds.high, [&](uint32_t id) {
    const LocalTriangle triangle = localTriangle(scene, frame, id);
    if (!meets(triangle, around)) return false;
    const std::optional<Box> part = partInside(triangle, around);
    if (part) found.push_back({leastMove(whole, *part, insets, margin, limit).distance, id});
    return false;
  });
  std::ranges::sort(found, [](const Near& a, const Near& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.id < b.id;
  });
  for (const Near& next : found) {
    const Box box{whole.low + insets.low, whole.high - insets.high};
    const LocalTriangle triangle = localTriangle(scene, frame, next.id);
    if (!meets(triangle, grown(box, near))) continue;
    const std::optional<Box> part = partInside(triangle, grown(box, near));
    if (!part) continue;
    const Move move = leastMove(box, *part, insets, margin, limit);
    if (move.distance == HUGE_VAL) return std::nullopt;
    (move.high ? insets.high : insets.low)[move.axis] += move.distance;
  }
  return insets;
}

ViewCell withInsets(ViewCell cell, const SideInsets& insets) {
  cell.center = cellFrame(cell).toWorld((insets.low - insets.high) * 0.5);
  cell.size -= insets.low + insets.high;
  return cell;
}

double defaultMargin(const Bounds& bounds, double extent) {
  const glm::vec3 reach = glm::max(glm::abs(bounds.low), glm::abs(bounds.high));
  const double spacing = double(std::max({reach.x, reach.y, reach.z})) * kSpacing;
  return std::min(std::max(extent * kMarginShare, spacing), extent * kLargestMarginShare);
}

void checkMargin(double margin, double extent, const std::string& what) {
  if (margin >= 0 && margin <= extent * kLargestMarginShare) return;
  throw Error(
      fmt::format("{}: a margin of {:g} is not between 0 and an eighth of their smallest extent, {:g}; "
                  "take larger cells or a smaller margin",
                  what, margin, extent),
      kExitUsage);
}

}  // namespace sightline
