#include "core/bake/report.h"

#include <fmt/core.h>
#include <sys/resource.h>

#include "core/bake/cell_json.h"
#include "core/bake/report_json.h"
#include "core/base/text.h"

namespace sightline {
namespace {

Json toJson(const std::optional<TreeSummary>& tree, uint64_t triangles) {
  if (!tree) return nullptr;
  return {{"build_seconds", tree->build_seconds},
          {"sah_cost", tree->sah_cost},
          {"depth", tree->depth},
          {"nodes2", tree->nodes2},
          {"nodes8", tree->nodes8},
          {"references", tree->references},
          {"bytes", tree->bytes},
          {"bytes_per_triangle", triangles == 0 ? 0.0 : double(tree->bytes) / double(triangles)}};
}

Json toJson(const std::vector<CellWarning>& warnings) {
  Json list = Json::array();
  for (const CellWarning& warning : warnings) {
    Json json = {{"verdict", verdictName(warning.verdict)}, {"text", warning.text}};
    if (warning.verdict == CellVerdict::kMeetsTriangles) json["met_triangles"] = warning.triangles;
    list.push_back(json);
  }
  return list;
}

Json toJson(const std::optional<Leaks>& leaks) {
  if (!leaks) return nullptr;
  Json json = {{"narrower_than", leaks->width},
               {"triangles", leaks->triangles},
               {"rays", leaks->rays},
               {"seconds", leaks->seconds}};
  if (leaks->triangles == 0) return json;
  json["first_triangle"] = leaks->first_triangle;
  json["place"] = {leaks->place.x, leaks->place.y, leaks->place.z};
  return json;
}

Json toJson(const std::vector<NamedTriangles>& objects) {
  Json list = Json::array();
  for (const NamedTriangles& object : objects) {
    list.push_back({{"name", object.name}, {"first_triangle", object.first}, {"triangles", object.count}});
  }
  return list;
}

}  // namespace

TreeSummary summarize(const Bvh& bvh) {
  TreeSummary tree;
  tree.build_seconds = bvh.build_seconds;
  tree.sah_cost = bvh.sah_cost;
  tree.depth = bvh.depth;
  tree.nodes2 = bvh.nodes2.size();
  tree.nodes8 = bvh.nodes8.size();
  tree.references = bvh.references.size();
  tree.bytes = tree.nodes2 * sizeof(BvhNode2) + tree.nodes8 * sizeof(BvhNode8) +
               tree.references * sizeof(uint32_t) + bvh.instances.size() * sizeof(InstanceRecord) +
               bvh.instance_order.size() * sizeof(uint32_t);
  return tree;
}

SceneSummary summarize(const Scene& scene, const std::string& name, uint64_t hash) {
  return {name,
          hash,
          scene.triangleCount(),
          scene.vertexCount(),
          scene.objects.size(),
          scene.degenerate_triangles,
          scene.repaired_triangles,
          scene.alpha_triangles,
          scene.glass_triangles,
          scene.single_sided_triangles,
          scene.hidden_nodes,
          scene.opaque_mask_triangles,
          countSurfaces(scene),
          scene.warnings,
          scene.offset,
          scene.instances.size(),
          scene.triangles.size()};
}

std::vector<CellWarning> warningsOf(const BakeReport& report, size_t index) {
  std::vector<CellWarning> warnings;
  if (index < report.warnings.size()) warnings = report.warnings[index];
  const uint64_t triangles = report.scene.triangles - report.scene.degenerate;
  if (const auto warning = checkSetSize(report.cells[index].pvs_size, triangles)) {
    warnings.push_back(*warning);
  }
  return warnings;
}

std::string reportJson(const BakeReport& report) {
  Json cells = Json::array();
  for (size_t i = 0; i < report.cells.size(); ++i) {
    const CellSummary& cell = report.cells[i];
    Json json = cellToJson(cell.cell, report.scene.offset);
    json["warnings"] = toJson(warningsOf(report, i));
    addCellStatistics(json, cell, report.scene.triangles);
    json["leaks"] = i < report.leaks.size() ? toJson(report.leaks[i]) : Json(nullptr);
    if (i < report.bounds.size()) {
      json["states"] = {{"seen", cell.pvs_size},
                        {"open", report.bounds[i] - cell.pvs_size},
                        {"hidden", report.scene.triangles - report.bounds[i]}};
    }
    cells.push_back(json);
  }
  const Json json = {{"sightline", report.version},
                     {"complete", report.cells.size() == report.planned_cells},
                     {"baked_on", report.baked_on},
                     {"device", toJson(report.device)},
                     {"seed", report.params.seed},
                     {"parameters", toJson(report.params)},
                     {"features",
                      {{"set", report.set.empty() ? Json(nullptr) : Json(report.set)},
                       {"spatial_splits", report.spatial_splits},
                       {"witnesses", report.witnesses},
                       {"repair", report.repair},
                       {"ignored_extensions", report.ignored_extensions},
                       {"doors", toJson(report.doors)},
                       {"see_through", toJson(report.see_through)},
                       {"smallest_hole", report.params.smallest_hole > 0}}},
                     {"scene", toJson(report.scene)},
                     {"tree", toJson(report.tree, report.scene.triangles)},
                     {"planned_cells", report.planned_cells},
                     {"resumed_cells", report.resumed_cells},
                     {"result_hash", hashText(hashResult(report.cells))},
                     {"seconds", report.seconds},
                     {"peak_process_bytes", report.peak_process_bytes},
                     {"cells", cells}};
  return jsonText(json);
}

std::vector<std::string> sceneWarnings(const SceneSummary& scene) {
  std::string materials;
  const auto add = [&](const std::string& what) { materials += (materials.empty() ? "" : "; ") + what; };
  if (scene.opaque_masks != 0) {
    add(fmt::format("{} triangles with masks are traced as opaque", scene.opaque_masks));
  }
  if (scene.single_sided != 0 && scene.surfaces.front_only == 0) {
    add(fmt::format("{} single-sided triangles are traced as two-sided", scene.single_sided));
  }
  std::vector<std::string> warnings = scene.warnings;
  if (!materials.empty()) warnings.insert(warnings.begin(), materials);
  return warnings;
}

std::string leaksText(const Leaks& leaks) {
  if (leaks.triangles == 0) return {};
  return fmt::format(
      "{} of the set {} seen only through gaps narrower than {:.3g}, triangle {} through one at ({:.6g}, "
      "{:.6g}, "
      "{:.6g}); --smallest-hole {:.3g} closes them",
      counted(leaks.triangles, "triangle"), leaks.triangles == 1 ? "is" : "are", leaks.width,
      leaks.first_triangle, leaks.place.x, leaks.place.y, leaks.place.z, leaks.width);
}

uint64_t peakProcessBytes() {
  rusage usage = {};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return uint64_t(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace sightline
