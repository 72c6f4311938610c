#include "core/scene/cell_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/cell/cell_frame.h"
#include "core/scene/contained.h"
#include "core/scene/largest.h"

namespace sightline {
namespace {

/// Of the scene's diagonal: cells so far beside its bounds, as a flight over it, are still taken to belong to
/// it.
constexpr double kBeside = 1.0 / 4;
/// Of the scene's diagonal: no viewer's room is so small.
constexpr double kSmallestShare = 1e-6;
/// Of the largest coordinate: four times the spacing of floats just below a power of two.
constexpr double kFourSpacings = 0x1p-21;

double diagonal(const Bounds& bounds) {
  const glm::dvec3 extent = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
  return std::sqrt(glm::dot(extent, extent));
}

std::optional<CellWarning> checkTriangles(const Scene& scene, const Bvh& bvh, const ViewCell& cell) {
  const uint64_t met = containedTriangles(scene, bvh, cell).size();
  if (met == 0) return std::nullopt;
  return CellWarning{CellVerdict::kMeetsTriangles,
                     fmt::format("cuts or touches {} triangle{}, so it sees what is behind {}", met,
                                 met == 1 ? "" : "s", met == 1 ? "it" : "them"),
                     met};
}

std::optional<CellWarning> checkSolid(const Scene& scene, const ViewCell& cell, FreeSide free_side,
                                      const NearestHits& trace) {
  if (free_side == FreeSide::kAny) return std::nullopt;
  std::array<glm::vec3, kSolidProbes> directions = solidProbes();
  const glm::vec3 normal(cellFrame(cell).axes[2]), from(cell.center);
  std::array<Ray, kSolidProbes> rays;
  std::array<Hit, kSolidProbes> hits;
  for (size_t i = 0; i < rays.size(); ++i) {
    glm::vec3& d = directions[i];
    if (cell.flat() && glm::dot(d, normal) < 0) d = -d;
    rays[i] = {{from.x, from.y, from.z, 0}, {d.x, d.y, d.z, 0}};
  }
  trace(rays, hits);
  if (!inSolid(scene, free_side, directions, hits)) return std::nullopt;
  return CellWarning{CellVerdict::kInSolid,
                     fmt::format("lies inside something solid: it sees mostly {} faces (if the scene's faces "
                                 "are turned: --free-side {})",
                                 free_side == FreeSide::kFront ? "back" : "front",
                                 free_side == FreeSide::kFront ? "back" : "front")};
}

std::optional<CellWarning> checkPlace(const Bounds& bounds, const ViewCell& cell) {
  const double beside = std::max(largest(cell.size), diagonal(bounds) * kBeside);
  glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (const glm::vec3& corner : cellCorners(cell)) {
    low = glm::min(low, glm::dvec3(corner));
    high = glm::max(high, glm::dvec3(corner));
  }
  const glm::dvec3 gap = glm::max(low - glm::dvec3(bounds.high), glm::dvec3(bounds.low) - high);
  if (largest(gap) <= beside) return std::nullopt;
  return CellWarning{CellVerdict::kOutside,
                     fmt::format("lies outside the scene, {:.3g} away from its bounds", largest(gap))};
}

std::optional<CellWarning> checkExtent(const Bounds& bounds, const ViewCell& cell) {
  const double scene = diagonal(bounds), extent = largest(cell.size);
  if (extent > scene) {
    return CellWarning{
        CellVerdict::kTooLarge,
        fmt::format("is {:.3g} long, the whole scene {:.3g}: are they in the same unit?", extent, scene)};
  }
  if (extent < scene * kSmallestShare) {
    return CellWarning{CellVerdict::kTooSmall,
                       fmt::format("is at most {:.3g} long, less than a millionth of the scene ({:.3g}): are "
                                   "they in the same unit?",
                                   extent, scene)};
  }
  double smallest = extent, reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (cell.size[axis] > 0) smallest = std::min(smallest, cell.size[axis]);
    reach = std::max(reach, std::fabs(cell.center[axis]) + cell.size[axis] / 2);
  }
  if (smallest >= reach * kFourSpacings) return std::nullopt;
  return CellWarning{CellVerdict::kTooSmall,
                     fmt::format("is {:.3g} wide, hardly more than the step between floats that far from the "
                                 "origin: move scene and cells nearer to it",
                                 smallest)};
}

}  // namespace

const char* verdictName(CellVerdict verdict) {
  switch (verdict) {
    case CellVerdict::kMeetsTriangles:
      return "meets triangles";
    case CellVerdict::kInSolid:
      return "in solid";
    case CellVerdict::kOutside:
      return "outside";
    case CellVerdict::kTooLarge:
      return "too large";
    case CellVerdict::kTooSmall:
      return "too small";
    case CellVerdict::kSeesNothing:
      return "sees nothing";
    case CellVerdict::kSeesEverything:
      return "sees everything";
  }
  return "unknown";
}

std::vector<std::vector<CellWarning>> checkCells(const Scene& scene, const Bvh& bvh,
                                                 std::span<const ViewCell> cells, FreeSide free_side,
                                                 const NearestHits& trace) {
  const Bounds bounds = sceneBounds(scene);
  std::vector<std::vector<CellWarning>> result;
  for (const ViewCell& cell : cells) {
    std::vector<CellWarning>& warnings = result.emplace_back();
    for (auto& warning : {checkTriangles(scene, bvh, cell), checkSolid(scene, cell, free_side, trace),
                          checkPlace(bounds, cell), checkExtent(bounds, cell)}) {
      if (warning) warnings.push_back(*warning);
    }
  }
  return result;
}

std::optional<CellWarning> checkSetSize(uint64_t set_size, uint64_t triangles) {
  if (set_size == 0) return CellWarning{CellVerdict::kSeesNothing, "sees nothing"};
  if (set_size < triangles) return std::nullopt;
  return CellWarning{CellVerdict::kSeesEverything, "sees everything: every triangle of the scene"};
}

}  // namespace sightline
