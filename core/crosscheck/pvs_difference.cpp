#include "core/crosscheck/pvs_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/base/text.h"
#include "core/crosscheck/ray_answers.h"
#include "core/io/float_text.h"
#include "core/pvs/stage_name.h"
#include "core/trace/sights.h"

namespace sightline {
namespace {

/// Explains the triangles that are in `with` and not in `without`. found_by: place of the device of `with`.
void explain(const Judge& judge, const CellPvs& with, const CellPvs& without,
             const std::array<Device*, 2>& devices, uint32_t found_by, const RoundingLimit& limit,
             PvsDifference& result) {
  std::vector<DisputedTriangle> extra;
  std::vector<Ray> rays;
  for (size_t i = 0; i < with.triangles.size(); ++i) {
    const uint32_t triangle = with.triangles[i];
    if (std::binary_search(without.triangles.begin(), without.triangles.end(), triangle)) continue;
    extra.push_back({triangle, found_by, with.witnesses[i], {}, {}});
    rays.push_back({vec4(with.witnesses[i].origin, 0), vec4(with.witnesses[i].direction, 0)});
  }
  result.only[found_by] = extra.size();
  std::array<Sights, 2> sights;
  for (size_t d = 0; d < 2; ++d) sights[d].trace(*devices[d], rays);
  for (size_t i = 0; i < extra.size(); ++i) {
    DisputedTriangle& its = extra[i];
    its.hits = {sights[0].hits()[i], sights[1].hits()[i]};
    const auto sees = [&](const Sights& of) {
      bool found = false;
      of.visit(i, [&](uint32_t triangle) { found = found || triangle == its.triangle; });
      return found;
    };
    if (sees(sights[0]) && sees(sights[1])) {
      ++result.other_rays[found_by];
      continue;
    }
    const ExactHit exact = judge.nearest(judgeRay(rays[i]));
    for (size_t d = 0; d < 2; ++d) {
      its.rulings[d] = ruleSight(judge, rays[i], its.hits[d], sights[d].glassIds(i), exact, limit);
    }
    result.disputed.push_back(its);
  }
}

/// Finds the triangles that the cell's definition rules out.
void findFaults(const Judge& judge, const CellPvs& pvs, uint32_t found_by, PvsDifference& result) {
  const CellSight sight(pvs.cell);
  for (size_t i = 0; i < pvs.triangles.size(); ++i) {
    const uint32_t triangle = pvs.triangles[i];
    const Fault fault = sight.faultOf(judge.corners(triangle), pvs.witnesses[i]);
    if (fault != Fault::kNone) result.faulty.push_back({triangle, found_by, fault, pvs.witnesses[i]});
  }
}

Json toJson(const DisputedTriangle& its, const std::array<std::string, 2>& names) {
  return {{"triangle", its.triangle},
          {"found_by", names[its.found_by]},
          {"stage", stageName(its.witness.stage)},
          {"origin", hexVector(its.witness.origin)},
          {"direction", hexVector(its.witness.direction)},
          {"answers", answersJson(its.hits, its.rulings, names)}};
}

Json toJson(const FaultyTriangle& its, const std::array<std::string, 2>& names) {
  return {{"triangle", its.triangle},
          {"found_by", names[its.found_by]},
          {"fault", faultName(its.fault)},
          {"stage", stageName(its.witness.stage)},
          {"origin", hexVector(its.witness.origin)},
          {"direction", hexVector(its.witness.direction)}};
}

}  // namespace

uint64_t PvsDifference::faults(size_t device) const {
  return uint64_t(std::count_if(faulty.begin(), faulty.end(),
                                [&](const FaultyTriangle& its) { return its.found_by == device; }));
}

uint64_t PvsDifference::count(size_t device, Verdict verdict) const {
  return uint64_t(std::count_if(disputed.begin(), disputed.end(), [&](const DisputedTriangle& its) {
    return its.rulings[device].verdict == verdict;
  }));
}

PvsDifference comparePvs(const Judge& judge, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                         Device& first, Device& other, const BakeParams& params, const RoundingLimit& limit,
                         const BakeHooks& hooks) {
  const CellPvs a = bakeCell(first, scene, cell, cell_index, params, hooks);
  const CellPvs b = bakeCell(other, scene, cell, cell_index, params, hooks);
  PvsDifference result;
  result.cell = cell.name;
  result.sizes = {a.triangles.size(), b.triangles.size()};
  explain(judge, a, b, {&first, &other}, 0, limit, result);
  explain(judge, b, a, {&first, &other}, 1, limit, result);
  findFaults(judge, a, 0, result);
  findFaults(judge, b, 1, result);
  return result;
}

std::string pvsDifferenceTable(const std::string& first, const std::string& other,
                               const std::vector<PvsDifference>& cells) {
  size_t width = 4;
  for (const PvsDifference& cell : cells) width = std::max(width, cell.cell.size());
  std::string table =
      fmt::format("sets of {} and {}\n{:<{}}  {:>9} {:>9}  {:>8} {:>8}  {:>11}  {:>8}", first, other, "cell",
                  width, "first", "other", "only 1st", "only 2nd", "other rays", "disputed");
  table += "  right 1st / 2nd  rounded 1st / 2nd  missed 1st / 2nd  wrong 1st / 2nd  not of cell 1st / 2nd\n";
  for (const PvsDifference& cell : cells) {
    table += fmt::format("{:<{}}  {:>9} {:>9}  {:>8} {:>8}  {:>11}  {:>8}", cell.cell, width, cell.sizes[0],
                         cell.sizes[1], cell.only[0], cell.only[1], cell.other_rays[0] + cell.other_rays[1],
                         cell.disputed.size());
    for (const Verdict verdict : kAllVerdicts) {
      table += fmt::format("  {:>7} / {:<6}", cell.count(0, verdict), cell.count(1, verdict));
    }
    table += fmt::format("  {:>9} / {}\n", cell.faults(0), cell.faults(1));
  }
  return table;
}

Json pvsDifferenceJson(const std::string& first, const std::string& other,
                       const std::vector<PvsDifference>& cells) {
  const std::array<std::string, 2> names{first, other};
  Json json = {{"first", first}, {"other", other}, {"cells", Json::array()}};
  for (const PvsDifference& cell : cells) {
    Json its = {{"name", cell.cell},
                {"sizes", {cell.sizes[0], cell.sizes[1]}},
                {"only", {cell.only[0], cell.only[1]}},
                {"other_rays", {cell.other_rays[0], cell.other_rays[1]}},
                {"disputed", Json::array()},
                {"faulty", Json::array()}};
    for (const DisputedTriangle& triangle : cell.disputed) its["disputed"].push_back(toJson(triangle, names));
    for (const FaultyTriangle& triangle : cell.faulty) its["faulty"].push_back(toJson(triangle, names));
    json["cells"].push_back(its);
  }
  return json;
}

}  // namespace sightline
