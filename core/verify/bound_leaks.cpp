#include "core/verify/bound_leaks.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "core/base/text.h"
#include "core/bound/bound_cell.h"
#include "core/bound/leak.h"

namespace sightline {
namespace {

constexpr size_t kMostShown = 5;  // leaks of a cell, in text

// How far along its witness, at most, a triangle is exactly seen; nothing: it is not.
std::optional<double> seenAt(const Judge& judge, const JudgeRay& ray, uint32_t triangle) {
  const ExactHit hit = judge.nearest(ray);
  if (hit.contains(triangle)) return hit.t.high;
  if (!judge.isGlass(triangle) || !judge.sees(ray, triangle)) return std::nullopt;
  const auto distance = judge.planeDistance(ray, triangle);
  return distance ? std::optional(distance->high) : std::nullopt;
}

Json arrayOf(const glm::dvec3& v) {
  return Json::array({v.x, v.y, v.z});
}

}  // namespace

BoundLeaks findBoundLeaks(const Judge& judge, const BoundScene& voxels, const CellPvs& set,
                          const std::vector<uint32_t>& bound) {
  BoundLeaks result;
  result.cell = set.cell.name;
  std::vector<uint32_t> outside;
  std::set_difference(set.triangles.begin(), set.triangles.end(), bound.begin(), bound.end(),
                      std::back_inserter(outside));
  if (outside.empty()) return result;
  const BlockedSpace opaque = innerVoxels(voxels, set.cell);
  for (const uint32_t triangle : outside) {
    const auto at = std::lower_bound(set.triangles.begin(), set.triangles.end(), triangle);
    const Witness& witness = set.witnesses[size_t(at - set.triangles.begin())];
    if (witness.stage == kStageContained) {
      result.unexplained.push_back(triangle);
      continue;
    }
    const JudgeRay ray{glm::dvec3(witness.origin), glm::dvec3(witness.direction)};
    const std::optional<double> seen_at = seenAt(judge, ray, triangle);
    if (!seen_at) {
      result.unproved.push_back(triangle);
    } else if (const auto place = opaquePlace(ray.origin, ray.origin + ray.direction * *seen_at,
                                              voxels.all.lattice, opaque)) {
      result.leaks.push_back({triangle, witness, *place});
    } else {
      result.unexplained.push_back(triangle);
    }
  }
  return result;
}

std::string boundLeaksText(const std::vector<BoundLeaks>& cells) {
  std::string text;
  for (const BoundLeaks& cell : cells) {
    text += fmt::format("{}: {} of the set {} outside the bound, each shown by an exact ray\n", cell.cell,
                        counted(cell.leaks.size(), "triangle"), cell.leaks.size() == 1 ? "is" : "are");
    for (size_t i = 0; i < std::min(cell.leaks.size(), kMostShown); ++i) {
      const BoundLeak& leak = cell.leaks[i];
      text += fmt::format(
          "  {} from ({:.6g}, {:.6g}, {:.6g}) enters an opaque voxel at ({:.6g}, {:.6g}, {:.6g})\n",
          leak.triangle, leak.ray.origin.x, leak.ray.origin.y, leak.ray.origin.z, leak.place.x, leak.place.y,
          leak.place.z);
    }
    if (cell.leaks.size() > kMostShown)
      text += fmt::format("  ... and {} more\n", cell.leaks.size() - kMostShown);
    if (!cell.unproved.empty()) {
      text += fmt::format("  {} more, met up to rounding only, the first {}\n", cell.unproved.size(),
                          cell.unproved.front());
    }
    if (!cell.unexplained.empty()) {
      text +=
          fmt::format("  {} more without an opaque voxel on the way, the first {}: bound or set is wrong\n",
                      cell.unexplained.size(), cell.unexplained.front());
    }
  }
  return text;
}

Json boundLeaksJson(const std::vector<BoundLeaks>& cells) {
  Json list = Json::array();
  for (const BoundLeaks& cell : cells) {
    Json leaks = Json::array();
    for (const BoundLeak& leak : cell.leaks) {
      leaks.push_back({{"triangle", leak.triangle},
                       {"origin", arrayOf(glm::dvec3(leak.ray.origin))},
                       {"direction", arrayOf(glm::dvec3(leak.ray.direction))},
                       {"place", arrayOf(leak.place)}});
    }
    list.push_back({{"name", cell.cell},
                    {"leaks", std::move(leaks)},
                    {"unproved", cell.unproved},
                    {"unexplained", cell.unexplained}});
  }
  return list;
}

}  // namespace sightline
