#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/type_precision.hpp>
#include <string>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/place/clear_box.h"
#include "core/place/place_cells.h"
#include "core/place/probe_solid.h"
#include "core/scene/box_triangle.h"
#include "core/scene/leaves_in_box.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {
namespace {

/// Between looks at the stop flag and calls of the progress: some tens of milliseconds.
constexpr uint64_t kBoxesAtATime = 1024;

/// A side comes in by this many margins at most: one for what touches the box, one for what reaches into it
/// by less than a margin.
constexpr double kMostMargins = 2;

/// Of a step: an end so near to a box's side by rounding is on it.
constexpr double kSameStep = 1e-6;

/// A box of this share of the size must be free: those that only touch a triangle are.
constexpr double kTouching = 1 - 0x1p-20;

enum class Verdict : uint8_t { kKept, kBlocked, kNothingBelow, kTooHigh, kInSolid, kNotReached };

struct CenteredBox {
  glm::dvec3 center, half_size;
};

bool meetsAnything(const Scene& scene, const Bvh& bvh, const CenteredBox& box) {
  return anyInLeaves(bvh, box.center - box.half_size, box.center + box.half_size, [&](uint32_t id) {
    const auto t = scene.corners(id);
    const glm::dvec3 corners[3] = {glm::dvec3(t[0]) - box.center, glm::dvec3(t[1]) - box.center,
                                   glm::dvec3(t[2]) - box.center};
    return triangleMeetsBox(corners, box.half_size);
  });
}

Ray makeRay(const glm::dvec3& origin, const glm::vec3& direction) {
  const glm::vec3 from(origin);
  return {{from.x, from.y, from.z, 0}, {direction.x, direction.y, direction.z, 0}};
}

/// What became of a box.
struct Outcome {
  Verdict verdict = Verdict::kBlocked;
  SideInsets insets;
};

/// Judges the boxes of one grid.
class BoxJudge {
 public:
  BoxJudge(const Scene& scene, const Bvh& bvh, const GridOptions& options, double margin)
      : scene_(scene),
        bvh_(bvh),
        options_(options),
        margin_(margin),
        tracer_(scene, bvh),
        probe_(scene, tracer_, options.free_side) {}

  Outcome judge(const glm::dvec3& center) const {
    const std::optional<SideInsets> insets = insetsAt(center);
    if (!insets) return {Verdict::kBlocked, {}};
    const Hit below = tracer_.trace(makeRay(center, {0, -1, 0}));
    if (below.triangle == kNoTriangle) return {Verdict::kNothingBelow, {}};
    if (options_.max_height > 0 && below.t - options_.size.y / 2 > options_.max_height) {
      return {Verdict::kTooHigh, {}};
    }
    if (options_.space != nullptr) {
      if (!isReached(center, *insets)) return {Verdict::kNotReached, {}};
    } else if (probe_.isInSolid(center)) {
      return {Verdict::kInSolid, {}};
    }
    return {Verdict::kKept, *insets};
  }

 private:
  /// Nothing: a triangle is in the box.
  std::optional<SideInsets> insetsAt(const glm::dvec3& center) const {
    if (margin_ > 0) {
      const CellFrame frame = cellFrame({"", center, options_.size, glm::dvec3(0)});
      return insetsToClear(scene_, bvh_, frame, margin_, glm::dvec3(kMostMargins * margin_));
    }
    if (meetsAnything(scene_, bvh_, {center, options_.size * (0.5 * kTouching)})) return std::nullopt;
    return SideInsets{};
  }

  /// Whether a free voxel of the space has a part in the box.
  bool isReached(const glm::dvec3& center, const SideInsets& insets) const {
    const Lattice& lattice = options_.space->grid().lattice;
    const double size = lattice.voxelSize();
    const glm::dvec3 half = options_.size * 0.5;
    const glm::ivec3 low = voxelAt(lattice, center - half + insets.low);
    const glm::dvec3 end = (center + half - insets.high) / size;
    const glm::ivec3 high = glm::max(low, glm::ivec3(glm::ceil(end)) - 1);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          if (options_.space->state({x, y, z}) == VoxelState::kFree) return true;
        }
      }
    }
    return false;
  }

  const Scene& scene_;
  const Bvh& bvh_;
  const GridOptions& options_;
  double margin_;
  CpuTracer tracer_;
  SolidProbe probe_;
};

/// First step of the grid along an axis, and how many.
struct Steps {
  int64_t first = 0;
  uint64_t count = 0;
};

/// The steps from the origin on that have a part between low and high; where the two are equal, one.
Steps stepsOver(double low, double high, double origin, double size) {
  const double first = std::max(0.0, std::floor((low - origin) / size + kSameStep));
  double last = std::ceil((high - origin) / size - kSameStep);
  if (low == high && low >= origin - size * kSameStep) last = std::max(last, first + 1);
  if (last <= first) return {0, 0};
  if (!(first < 1e15) || !(last - first <= double(kMaxGridBoxes))) return {0, kMaxGridBoxes + 1};
  return {int64_t(first), uint64_t(last - first)};
}

Steps stepsOf(const GridOptions& options, const Bounds& bounds, const glm::dvec3& origin, int axis) {
  const double size = options.size[axis];
  Steps steps;
  if (options.region) {
    steps = stepsOver(options.region->low[axis], options.region->high[axis], origin[axis], size);
  } else if (options.count) {
    steps = {0, (*options.count)[size_t(axis)]};
  } else {
    steps = stepsOver(bounds.low[axis], bounds.high[axis], origin[axis], size);
  }
  if (options.count && steps.count != 0) {
    const int64_t end = int64_t(std::min((*options.count)[size_t(axis)], kMaxGridBoxes + 1));
    steps.count = uint64_t(std::clamp(end - steps.first, int64_t(0), int64_t(steps.count)));
  }
  return steps;
}

/// The boxes of a grid, by number.
struct Grid {
  glm::dvec3 origin{0.0}, size{0.0};
  Steps steps[3];

  uint64_t boxes() const { return steps[0].count * steps[1].count * steps[2].count; }
  glm::i64vec3 placeOf(uint64_t i) const {
    const uint64_t x = i % steps[0].count, z = i / steps[0].count % steps[2].count;
    const uint64_t y = i / steps[0].count / steps[2].count;
    return {steps[0].first + int64_t(x), steps[1].first + int64_t(y), steps[2].first + int64_t(z)};
  }
  glm::dvec3 centerOf(uint64_t i) const { return origin + (glm::dvec3(placeOf(i)) + 0.5) * size; }
};

Grid gridOver(const Bounds& bounds, const GridOptions& options) {
  Grid grid{options.origin.value_or(options.region ? options.region->low : glm::dvec3(bounds.low)),
            options.size,
            {}};
  double total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    grid.steps[axis] = stepsOf(options, bounds, grid.origin, axis);
    total *= double(grid.steps[axis].count);
  }
  if (total == 0) {
    throw Error(std::string("grid of cells: no box from the origin on is in the ") +
                    (options.region ? "region" : "scene") + "; lower the origin" +
                    (options.region ? ", or set another region" : ", or set a count"),
                kExitUsage);
  }
  if (!(total <= double(kMaxGridBoxes))) {
    throw Error("grid of cells: more than " + std::to_string(kMaxGridBoxes) +
                    " boxes of that size; take a larger one, or a smaller region",
                kExitUsage);
  }
  return grid;
}

void checkRegion(const GridRegion& region) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(region.low[axis]) && std::isfinite(region.high[axis]) &&
        region.low[axis] <= region.high[axis]) {
      continue;
    }
    throw Error("grid of cells: the region must run from its low to its high corner, in finite numbers",
                kExitUsage);
  }
}

void checkOptions(const GridOptions& options) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(options.size[axis] > 0) || !std::isfinite(options.size[axis])) {
      throw Error("grid of cells: sizes must be positive, finite numbers", kExitUsage);
    }
    if (options.origin && !std::isfinite((*options.origin)[axis])) {
      throw Error("grid of cells: the origin must be finite numbers", kExitUsage);
    }
  }
  if (!(options.max_height >= 0)) throw Error("grid of cells: the height must be 0 or more", kExitUsage);
  if (options.region) checkRegion(*options.region);
  if (options.count && std::ranges::min(*options.count) == 0) {
    throw Error("grid of cells: the counts must be 1 or more", kExitUsage);
  }
}

/// Judges boxes begin .. begin + outcomes.size() - 1. Throws Interrupted.
void judgeBoxes(const BoxJudge& judge, const Grid& grid, uint64_t begin, const std::atomic<bool>* stop,
                std::span<Outcome> outcomes) {
  tbb::parallel_for(size_t(0), outcomes.size(), [&](size_t i) {
    if (stop == nullptr || !*stop) outcomes[i] = judge.judge(grid.centerOf(begin + i));
  });
  if (stop != nullptr && *stop) throw Interrupted{};
}

std::string nameOf(const glm::i64vec3& place) {
  return "grid-" + std::to_string(place.x) + "-" + std::to_string(place.y) + "-" + std::to_string(place.z);
}

}  // namespace

std::vector<ViewCell> gridCells(const Scene& scene, const Bvh& bvh, const GridOptions& options,
                                GridCounts* counts, const GridHooks& hooks) {
  checkOptions(options);
  const Bounds bounds = sceneBounds(scene);
  const Grid grid = gridOver(bounds, options);
  const double smallest = std::min({options.size.x, options.size.y, options.size.z});
  const double margin = options.margin.value_or(defaultMargin(bounds, smallest));
  checkMargin(margin, smallest, "grid of cells");
  const BoxJudge judge(scene, bvh, options, margin);

  std::vector<ViewCell> cells;
  uint64_t tally[6] = {}, inset = 0;
  std::vector<Outcome> outcomes;
  for (uint64_t begin = 0; begin < grid.boxes(); begin += outcomes.size()) {
    if (hooks.progress) hooks.progress(begin, grid.boxes());
    outcomes.resize(std::min(kBoxesAtATime, grid.boxes() - begin));
    judgeBoxes(judge, grid, begin, hooks.stop, outcomes);
    for (size_t i = 0; i < outcomes.size(); ++i) {
      tally[size_t(outcomes[i].verdict)]++;
      if (outcomes[i].verdict != Verdict::kKept) continue;
      inset += outcomes[i].insets.none() ? 0 : 1;
      const ViewCell box{nameOf(grid.placeOf(begin + i)), grid.centerOf(begin + i), options.size,
                         glm::dvec3(0)};
      cells.push_back(withInsets(box, outcomes[i].insets));
    }
  }
  if (counts != nullptr) {
    *counts = {grid.boxes(), tally[0], tally[1], tally[2], tally[3], tally[4], tally[5], inset};
  }
  return cells;
}

}  // namespace sightline
