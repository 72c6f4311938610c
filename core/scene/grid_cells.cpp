#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "core/device/cpu_tracer.h"
#include "core/error.h"
#include "core/scene/box_triangle.h"
#include "core/scene/place_cells.h"

namespace sightline {
namespace {

constexpr int kProbes = 64;

/// A box of this share of the size must be free: those that only touch a triangle are.
constexpr double kTouching = 1 - 0x1p-20;

enum class Verdict : uint8_t { kKept, kBlocked, kNothingBelow, kTooHigh, kInSolid };

struct Box {
  glm::dvec3 center, half_size;
};

bool triangleMeets(const Scene& scene, uint32_t id, const Box& box) {
  const glm::uvec3 t = scene.triangles[id];
  const glm::dvec3 corners[3] = {glm::dvec3(scene.positions[t.x]) - box.center,
                                 glm::dvec3(scene.positions[t.y]) - box.center,
                                 glm::dvec3(scene.positions[t.z]) - box.center};
  return triangleMeetsBox(corners, box.half_size);
}

bool overlaps(const glm::vec4& range_x, const glm::vec4& range_y, const glm::vec4& range_z, int child,
              const glm::dvec3& low, const glm::dvec3& high) {
  const int l = 2 * child, h = l + 1;
  return range_x[l] <= high.x && range_x[h] >= low.x && range_y[l] <= high.y && range_y[h] >= low.y &&
         range_z[l] <= high.z && range_z[h] >= low.z;
}

bool meetsAnything(const Scene& scene, const Bvh& bvh, const Box& box) {
  const glm::dvec3 low = box.center - box.half_size, high = box.center + box.half_size;
  std::vector<uint32_t> stack{0};
  while (!stack.empty()) {
    const BvhNode2& node = bvh.nodes2[stack.back()];
    stack.pop_back();
    for (int child = 0; child < 2; ++child) {
      if (!overlaps(node.x, node.y, node.z, child, low, high)) continue;
      if (node.count[child] == 0) {
        stack.push_back(node.child[child]);
        continue;
      }
      for (uint32_t i = 0; i < node.count[child]; ++i) {
        if (triangleMeets(scene, bvh.references[node.child[child] + i], box)) return true;
      }
    }
  }
  return false;
}

Ray makeRay(const glm::dvec3& origin, const glm::vec3& direction) {
  const glm::vec3 from(origin);
  return {{from.x, from.y, from.z, 0}, {direction.x, direction.y, direction.z, 0}};
}

/// Directions over the whole sphere: even in height, turned by the golden ratio, none along an axis.
std::array<glm::vec3, kProbes> probeDirections() {
  std::array<glm::vec3, kProbes> directions;
  for (int i = 0; i < kProbes; ++i) {
    const double y = 1 - 2 * (i + 0.5) / kProbes, r = std::sqrt(1 - y * y),
                 turn = 2.399963229728653 * (i + 0.5);
    directions[size_t(i)] = glm::vec3(r * std::cos(turn), y, r * std::sin(turn));
  }
  return directions;
}

bool hitsBack(const Scene& scene, uint32_t id, const glm::vec3& direction) {
  const glm::uvec3 t = scene.triangles[id];
  const glm::dvec3 a = scene.positions[t.x];
  const glm::dvec3 normal =
      glm::cross(glm::dvec3(scene.positions[t.y]) - a, glm::dvec3(scene.positions[t.z]) - a);
  return glm::dot(normal, glm::dvec3(direction)) > 0;
}

bool inSolid(const Scene& scene, const CpuTracer& tracer, FreeSide free_side, const glm::dvec3& point) {
  if (free_side == FreeSide::kAny) return false;
  static const std::array<glm::vec3, kProbes> kDirections = probeDirections();
  int hits = 0, wrong = 0;
  for (const glm::vec3& direction : kDirections) {
    const Hit hit = tracer.trace(makeRay(point, direction));
    if (hit.triangle == kNoTriangle) continue;
    hits++;
    wrong += hitsBack(scene, hit.triangle, direction) == (free_side == FreeSide::kFront);
  }
  return 2 * wrong > hits;
}

Verdict judge(const Scene& scene, const Bvh& bvh, const CpuTracer& tracer, const GridOptions& options,
              const glm::dvec3& center) {
  if (meetsAnything(scene, bvh, {center, options.size * (0.5 * kTouching)})) return Verdict::kBlocked;
  const Hit below = tracer.trace(makeRay(center, {0, -1, 0}));
  if (below.triangle == kNoTriangle) return Verdict::kNothingBelow;
  if (options.max_height > 0 && below.t - options.size.y / 2 > options.max_height) return Verdict::kTooHigh;
  if (inSolid(scene, tracer, options.free_side, center)) return Verdict::kInSolid;
  return Verdict::kKept;
}

/// First step of the grid along an axis, and how many.
struct Steps {
  int64_t first = 0;
  uint64_t count = 0;
};

Steps stepsOver(double low, double high, double origin, double size) {
  const double first = std::floor((low - origin) / size);
  const double last = std::max(first + 1, std::ceil((high - origin) / size));
  if (!(std::fabs(first) < 1e15) || last - first > double(kMaxGridBoxes)) return {0, kMaxGridBoxes + 1};
  return {int64_t(first), uint64_t(last - first)};
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
}

}  // namespace

std::vector<ViewCell> gridCells(const Scene& scene, const Bvh& bvh, const GridOptions& options,
                                GridCounts* counts) {
  checkOptions(options);
  const Bounds bounds = sceneBounds(scene);
  const glm::dvec3 origin = options.origin.value_or(glm::dvec3(bounds.low));
  Steps steps[3];
  double total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    steps[axis] = stepsOver(bounds.low[axis], bounds.high[axis], origin[axis], options.size[axis]);
    total *= double(steps[axis].count);
  }
  if (total > double(kMaxGridBoxes)) {
    throw Error("grid of cells: the scene takes more than " + std::to_string(kMaxGridBoxes) +
                    " boxes of that size; take a larger one",
                kExitUsage);
  }
  const auto centerOf = [&](uint64_t i) {
    const uint64_t x = i % steps[0].count, z = i / steps[0].count % steps[2].count;
    const uint64_t y = i / steps[0].count / steps[2].count;
    const glm::dvec3 step(double(steps[0].first + int64_t(x)), double(steps[1].first + int64_t(y)),
                          double(steps[2].first + int64_t(z)));
    return origin + (step + 0.5) * options.size;
  };
  const CpuTracer tracer(scene, bvh);
  std::vector<Verdict> verdicts(size_t(total), Verdict::kBlocked);
  tbb::parallel_for(size_t(0), verdicts.size(),
                    [&](size_t i) { verdicts[i] = judge(scene, bvh, tracer, options, centerOf(i)); });

  std::vector<ViewCell> cells;
  uint64_t tally[5] = {};
  for (size_t i = 0; i < verdicts.size(); ++i) {
    tally[size_t(verdicts[i])]++;
    if (verdicts[i] != Verdict::kKept) continue;
    const uint64_t x = i % steps[0].count, z = i / steps[0].count % steps[2].count;
    const uint64_t y = i / steps[0].count / steps[2].count;
    cells.push_back({"grid-" + std::to_string(x) + "-" + std::to_string(y) + "-" + std::to_string(z),
                     centerOf(i), options.size, glm::dvec3(0)});
  }
  if (counts != nullptr) *counts = {verdicts.size(), tally[0], tally[1], tally[2], tally[3], tally[4]};
  return cells;
}

}  // namespace sightline
