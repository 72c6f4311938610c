#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/cell/rotation.h"
#include "core/place/clear_box.h"
#include "core/place/place_cells.h"
#include "core/scene/contained.h"

namespace sightline {
namespace {

/// Of a cell's extent: a side may come in so far. Half of the cell stays, the middle in it.
constexpr double kMostInsetShare = 0.25;

/// Length of a vector, from operations that every machine rounds alike, without overflow on the way.
double lengthOf(const glm::dvec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (largest == 0) return 0;
  const glm::dvec3 scaled = v / largest;
  return largest * std::sqrt(scaled.x * scaled.x + scaled.y * scaled.y + scaled.z * scaled.z);
}

struct Stretch {
  glm::dvec3 from, direction;  // direction of length 1
  double length;
};

void checkOptions(const PathOptions& options) {
  for (const double size : {options.width, options.height, options.length}) {
    if (!(size > 0) || !std::isfinite(size)) {
      throw Error("cells along a path: width, height and length must be positive, finite numbers",
                  kExitUsage);
    }
  }
}

std::vector<Stretch> stretchesOf(std::span<const glm::dvec3> points) {
  std::vector<Stretch> stretches;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y) || !std::isfinite(points[i].z)) {
      throw Error("cells along a path: point " + std::to_string(i + 1) + " is not finite", kExitUsage);
    }
    if (i == 0 || points[i] == points[i - 1]) continue;
    const glm::dvec3 step = points[i] - points[i - 1];
    const double length = lengthOf(step);
    stretches.push_back({points[i - 1], step / length, length});
  }
  if (stretches.empty()) throw Error("cells along a path: takes two different points or more", kExitUsage);
  return stretches;
}

/// How much longer two boxes get at the bend between them.
///
///      outer side   ____ ___
///                       |  _|    a = half * tan(angle / 2)
///        =============--+-/ a
///                      /  /
double bendLength(const Stretch& a, const Stretch& b, const PathOptions& options) {
  const double cosine = glm::dot(a.direction, b.direction);
  const glm::dvec3 turn = glm::cross(a.direction, b.direction);
  const bool level = turn.x == 0 && turn.z == 0;  // turns about y only: no height in it
  const double half = (level ? options.width : std::max(options.width, options.height)) / 2;
  // tan(angle / 2) = sin / (1 + cos); at most that of a right angle.
  return half * std::min(1.0, lengthOf(turn) / std::max(1e-9, 1 + cosine));
}

}  // namespace

std::vector<ViewCell> pathCells(std::span<const glm::dvec3> points, const PathOptions& options) {
  checkOptions(options);
  const std::vector<Stretch> stretches = stretchesOf(points);
  std::vector<ViewCell> cells;
  for (size_t s = 0; s < stretches.size(); ++s) {
    const Stretch& stretch = stretches[s];
    const double boxes = std::ceil(stretch.length / options.length);
    if (boxes + double(cells.size()) > double(kMaxGridBoxes)) {
      throw Error(
          "cells along a path: more than " + std::to_string(kMaxGridBoxes) + " boxes; take a greater length",
          kExitUsage);
    }
    // Local z leaves along the path: pitch about x first (down is positive), then yaw about y.
    const glm::dvec3 d = stretch.direction;
    const double level = lengthOf({d.x, 0, d.z});
    const glm::dvec3 rotation(0.0 - atan2Degrees(d.y, level), atan2Degrees(d.x, d.z), 0);
    const double before = s > 0 ? bendLength(stretches[s - 1], stretch, options) : 0;
    const double after = s + 1 < stretches.size() ? bendLength(stretch, stretches[s + 1], options) : 0;
    for (double k = 0; k < boxes; ++k) {
      const double start = stretch.length * (k / boxes) - (k == 0 ? before : 0);
      const double end = stretch.length * ((k + 1) / boxes) + (k + 1 == boxes ? after : 0);
      cells.push_back({"path-" + std::to_string(cells.size() + 1),
                       stretch.from + d * ((start + end) / 2),
                       {options.width, options.height, end - start},
                       rotation});
    }
  }
  return cells;
}

ClearCells keepClear(const Scene& scene, const Bvh& bvh, std::span<const ViewCell> cells, double margin) {
  std::vector<std::optional<SideInsets>> insets(cells.size());
  tbb::parallel_for(size_t(0), cells.size(), [&](size_t i) {
    insets[i] = insetsToClear(scene, bvh, cellFrame(cells[i]), margin, cells[i].size * kMostInsetShare);
  });
  ClearCells result;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (!insets[i]) {
      result.blocked.push_back({cells[i], containedTriangles(scene, bvh, cells[i]).size()});
      continue;
    }
    result.inset += insets[i]->none() ? 0 : 1;
    result.cells.push_back(withInsets(cells[i], *insets[i]));
  }
  return result;
}

}  // namespace sightline
