#include "core/diff/pvs_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>

#include "core/base/text.h"
#include "core/pvs/cell_summary.h"
#include "core/pvs/param_table.h"

namespace sightline {
namespace {

constexpr const char* kNone = "none";

void compare(std::vector<ValueDifference>& list, const std::string& name, const std::string& a,
             const std::string& b) {
  if (a != b) list.push_back({name, {a, b}});
}

void compare(std::vector<ValueDifference>& list, const std::string& name, uint64_t a, uint64_t b) {
  if (a != b) list.push_back({name, {std::to_string(a), std::to_string(b)}});
}

std::string intersectorText(const PvsFile& pvs) {
  return pvs.intersector.empty() ? "of cpu and opencl" : "of " + pvs.intersector;
}

bool sameScene(const PvsFile& a, const PvsFile& b) {
  return a.scene_hash == b.scene_hash && a.triangle_count == b.triangle_count;
}

std::string shapeText(const ViewCell& cell) {
  const auto text = [](const glm::dvec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); };
  return fmt::format("center {} size {} rotation {}", text(cell.center), text(cell.size),
                     text(cell.rotation));
}

/// Place in the plan and shape of each cell: the place enters its random rays.
std::map<std::string, std::string> planOf(const PvsFile& pvs) {
  std::map<std::string, std::string> plan;
  for (size_t i = 0; i < pvs.planned.size(); ++i) {
    plan[pvs.planned[i].name] = fmt::format("number {}, {}", i, shapeText(moved(pvs.planned[i], pvs.offset)));
  }
  return plan;
}

void comparePlans(std::vector<ValueDifference>& list, const PvsFile& a, const PvsFile& b) {
  compare(list, "planned cells", a.planned.size(), b.planned.size());
  const auto in_a = planOf(a), in_b = planOf(b);
  for (const ViewCell& cell : a.planned) {
    const auto other = in_b.find(cell.name);
    compare(list, "planned cell " + cell.name, in_a.at(cell.name),
            other == in_b.end() ? kNone : other->second);
  }
  for (const ViewCell& cell : b.planned) {
    if (!in_a.contains(cell.name)) compare(list, "planned cell " + cell.name, kNone, in_b.at(cell.name));
  }
}

std::string objectsText(const std::vector<NamedTriangles>& objects) {
  std::string text;
  for (const NamedTriangles& object : objects) {
    text += fmt::format("{}{} ({} + {})", text.empty() ? "" : ", ", object.name, object.first, object.count);
  }
  return text.empty() ? kNone : text;
}

std::vector<ValueDifference> compareInputs(const PvsFile& a, const PvsFile& b) {
  std::vector<ValueDifference> list;
  compare(list, "revision of the algorithm", a.algorithm, b.algorithm);
  compare(list, "intersection test", intersectorText(a), intersectorText(b));
  compare(list, "hash of the scene", hashText(a.scene_hash), hashText(b.scene_hash));
  compare(list, "triangles of the scene", a.triangle_count, b.triangle_count);
  for (const Param& param : kParams) {
    if (sameValue(param, a.params, b.params)) continue;
    list.push_back({param.name, {valueText(param, a.params), valueText(param, b.params)}});
  }
  compare(list, "witnesses", std::string(a.has_witnesses ? "yes" : "no"), b.has_witnesses ? "yes" : "no");
  comparePlans(list, a, b);
  compare(list, "doors", objectsText(a.doors), objectsText(b.doors));
  compare(list, "objects that hide nothing", objectsText(a.see_through), objectsText(b.see_through));
  return list;
}

void add(SomeIds& ids, uint32_t id) {
  if (++ids.count <= kListedIds) ids.first.push_back(id);
}

SomeIds onlyIn(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
  std::vector<uint32_t> ids;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(ids));
  SomeIds some;
  for (const uint32_t id : ids) add(some, id);
  return some;
}

bool sameBits(const Witness& a, const Witness& b) {
  return std::memcmp(&a.origin, &b.origin, sizeof a.origin) == 0 &&
         std::memcmp(&a.direction, &b.direction, sizeof a.direction) == 0 && a.stage == b.stage;
}

/// Counts the triangles of both sets, too.
SomeIds otherWitnesses(const CellPvs& a, const CellPvs& b, uint64_t& in_both) {
  SomeIds some;
  size_t j = 0;
  for (size_t i = 0; i < a.triangles.size(); ++i) {
    while (j < b.triangles.size() && b.triangles[j] < a.triangles[i]) ++j;
    if (j == b.triangles.size()) break;
    if (b.triangles[j] != a.triangles[i]) continue;
    ++in_both;
    if (a.witnesses.empty() || b.witnesses.empty()) continue;  // said of the bakes as wholes
    if (!sameBits(a.witnesses[i], b.witnesses[j])) add(some, a.triangles[i]);
  }
  return some;
}

std::vector<ValueDifference> compareStatistics(const CellStats& a, const CellStats& b) {
  std::vector<ValueDifference> list;
  const auto stage = [&](const std::string& name, const StageStats& in_a, const StageStats& in_b) {
    compare(list, name + " rays", in_a.rays, in_b.rays);
    compare(list, "new triangles by " + name, in_a.new_triangles, in_b.new_triangles);
  };
  stage("random", a.random, b.random);
  stage("border", a.border, b.border);
  stage("reverse", a.reverse, b.reverse);
  compare(list, "contained triangles", a.contained_triangles, b.contained_triangles);
  compare(list, "iterations", a.iterations, b.iterations);
  compare(list, "ended by", stopReasonName(a.stop), stopReasonName(b.stop));
  compare(list, "validation rays", a.validation_rays, b.validation_rays);
  compare(list, "missing rays", a.missing_rays, b.missing_rays);
  compare(list, "rays of the error's bound", a.bound_rays, b.bound_rays);
  compare(list, "tests of the error's bound", a.bound_tests, b.bound_tests);
  compare(list, "error's bound", fmt::format("{}", a.error_bound), fmt::format("{}", b.error_bound));
  return list;
}

const std::vector<uint32_t>& openedBy(const CellPvs& cell) {
  static const std::vector<uint32_t> nothing;
  return cell.open ? cell.open->triangles : nothing;
}

void compareCells(PvsDiff& diff, const PvsFile& a, const PvsFile& b) {
  std::map<std::string, const CellPvs*> in_b;
  for (const CellPvs& cell : b.cells) in_b[cell.cell.name] = &cell;
  for (const CellPvs& cell : a.cells) {
    const auto found = in_b.find(cell.cell.name);
    if (found == in_b.end()) {
      diff.unmatched.push_back(fmt::format("cell {} is baked in A only", cell.cell.name));
      continue;
    }
    const CellPvs& other = *found->second;
    in_b.erase(found);
    CellDiff difference{cell.cell.name,
                        {onlyIn(cell.triangles, other.triangles), onlyIn(other.triangles, cell.triangles)},
                        {onlyIn(openedBy(cell), openedBy(other)), onlyIn(openedBy(other), openedBy(cell))},
                        otherWitnesses(cell, other, diff.compared_triangles),
                        compareStatistics(cell.stats, other.stats)};
    ++diff.compared_cells;
    if (!difference.same()) diff.cells.push_back(std::move(difference));
  }
  for (const CellPvs& cell : b.cells) {
    if (in_b.contains(cell.cell.name)) {
      diff.unmatched.push_back(fmt::format("cell {} is baked in B only", cell.cell.name));
    }
  }
}

}  // namespace

PvsDiff diffPvs(const PvsFile& a, const PvsFile& b) {
  PvsDiff diff;
  diff.inputs = compareInputs(a, b);
  if (sameScene(a, b)) compareCells(diff, a, b);
  return diff;
}

}  // namespace sightline
