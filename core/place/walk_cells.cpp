#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/cell/cell_frame.h"
#include "core/cell/rotation.h"
#include "core/place/clear_box.h"
#include "core/place/place_cells.h"

namespace sightline {
namespace {

/// Eyes keep so far from a box's sides, as a share of its extent, that these can come in for the margin.
constexpr double kRoomShare = 0.25;
/// Of what a side may come in: the rest is for rounding.
constexpr double kWithinRoom = 1 - 0x1p-20;

double distanceOf(const glm::dvec3& v) {
  return std::sqrt(glm::dot(v, v));
}

/// A box around frames in a row, and how far its sides may come in and still hold all eyes.
struct WalkBox {
  ViewCell cell;
  SideInsets insets;
};

class WalkBoxes {
 public:
  WalkBoxes(const Scene& scene, const Bvh& bvh, const CameraPath& path, const PathOptions& options,
            double margin)
      : scene_(scene), bvh_(bvh), path_(path), options_(options), margin_(margin) {}

  /// Nothing: they do not fit into one, or triangles are in the way.
  std::optional<WalkBox> around(uint32_t first, uint32_t last) const {
    ViewCell cell = boxAlong(first, last);
    const CellFrame line = cellFrame(cell);
    glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (uint32_t frame = first; frame <= last; ++frame) {
      const glm::dvec3 local = line.toLocal(placeAt(path_, frame).eye);
      low = glm::min(low, local);
      high = glm::max(high, local);
    }
    const double end = kRoomShare * std::min(options_.width, options_.length);
    cell.size.z = high.z - low.z + 2 * end;
    if (cell.size.z > options_.length) return std::nullopt;
    cell.center = line.toWorld({0, 0, (low.z + high.z) / 2});
    low.z = -(cell.size.z / 2 - end), high.z = -low.z;
    const glm::dvec3 reach = glm::max(glm::abs(low), glm::abs(high)), half = cell.size * 0.5;
    if (reach.x > half.x - kRoomShare * cell.size.x || reach.y > half.y - kRoomShare * cell.size.y) {
      return std::nullopt;
    }
    if (margin_ == 0) return WalkBox{cell, {}};
    const std::optional<SideInsets> insets =
        insetsToClear(scene_, bvh_, cellFrame(cell), margin_, (half - reach) * kWithinRoom);
    if (!insets) return std::nullopt;
    return WalkBox{cell, *insets};
  }

  /// The last of the frames first .. end that one box can hold with all before it; nothing: not even one.
  std::optional<uint32_t> farthest(uint32_t first, uint32_t end) const {
    if (!around(first, first)) return std::nullopt;
    uint32_t fits = first, step = 1;
    while (fits < end && around(first, std::min(end, fits + step))) {
      fits = std::min(end, fits + step);
      step *= 2;
    }
    for (; step > 0; step /= 2) {
      if (fits + step <= end && around(first, fits + step)) fits += step;
    }
    return fits;
  }

 private:
  /// Its local z from the first eye to the last; if it stands still, where it looks, level.
  ViewCell boxAlong(uint32_t first, uint32_t last) const {
    const PathPlace from = placeAt(path_, first);
    glm::dvec3 d = placeAt(path_, last).eye - from.eye;
    if (d == glm::dvec3(0)) d = {from.look.x - from.eye.x, 0, from.look.z - from.eye.z};
    const double level = distanceOf({d.x, 0, d.z});
    return {"",
            from.eye,
            {options_.width, options_.height, 0},
            {0.0 - atan2Degrees(d.y, level), atan2Degrees(d.x, d.z), 0}};
  }

  const Scene& scene_;
  const Bvh& bvh_;
  const CameraPath& path_;
  const PathOptions& options_;
  double margin_;
};

}  // namespace

WalkCells walkCells(const Scene& scene, const Bvh& bvh, const CameraPath& path, const PathOptions& options,
                    double margin) {
  for (const double size : {options.width, options.height, options.length}) {
    if (!(size > 0) || !std::isfinite(size)) {
      throw Error("cells along a walk: width, height and length must be positive, finite numbers",
                  kExitUsage);
    }
  }
  checkMargin(margin, std::min({options.width, options.height, options.length}), "cells along a walk");
  const WalkBoxes boxes(scene, bvh, path, options, margin);
  WalkCells result;
  uint32_t end = 0;  // of the stretch without a cut
  for (uint32_t first = 0; first < path.frames();) {
    if (first >= end) {
      end = first;
      while (end + 1 < path.frames() && !startsStretch(path, end + 1)) ++end;
    }
    const std::optional<uint32_t> last = boxes.farthest(first, end);
    if (!last) {
      result.frames_left_out.push_back(first++);
      continue;
    }
    const std::optional<WalkBox> box = boxes.around(first, *last);
    result.inset += box->insets.none() ? 0 : 1;
    result.cells.push_back(withInsets(box->cell, box->insets));
    result.cells.back().name = "walk-" + std::to_string(result.cells.size());
    // The next one holds the last frame, too, so that boxes meet.
    first = *last == end || *last == first ? *last + 1 : *last;
  }
  return result;
}

}  // namespace sightline
