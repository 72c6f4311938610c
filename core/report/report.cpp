#include "core/report/report.h"

#include <fmt/core.h>
#include <sys/resource.h>

#include "core/report/cell_json.h"
#include "core/report/text.h"

namespace sightline {
namespace {

Json toJson(const SceneSummary& scene) {
  return {{"name", scene.name},
          {"hash", hashText(scene.hash)},
          {"triangles", scene.triangles},
          {"vertices", scene.vertices},
          {"objects", scene.objects},
          {"degenerate_triangles", scene.degenerate},
          {"repaired_triangles", scene.repaired},
          {"alpha_triangles", scene.alpha},
          {"single_sided_triangles", scene.single_sided}};
}

Json toJson(const std::optional<DeviceInfo>& device) {
  if (!device) return nullptr;
  return {{"id", device->id},
          {"name", device->name},
          {"driver", device->driver},
          {"layout", device->layout},
          {"memory_bytes", device->memory_bytes},
          {"driver_tree_parts", device->driver_tree_parts},
          {"driver_tree_bytes", device->driver_tree_bytes},
          {"driver_tree_build_seconds", device->driver_tree_build_seconds}};
}

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

Json toJson(const BakeParams& params) {
  return {{"method", methodName(params.method)},
          {"n_rand", params.n_rand},
          {"n_abs_edge", params.n_abs_edge},
          {"n_rs_edge", params.n_rs_edge},
          {"n_rs_area", params.n_rs_area},
          {"delta_abs_relative", params.delta_abs_relative},
          {"delta_abs", params.delta_abs},
          {"delta_rs_relative", params.delta_rs_relative},
          {"delta_rs", params.delta_rs},
          {"threshold", params.threshold},
          {"quiet_iterations", params.quiet_iterations},
          {"max_rays", params.max_rays},
          {"max_seconds", params.max_seconds},
          {"batch_rays", params.batch_rays},
          {"validation_rays", params.validation_rays},
          {"raster_resolution", params.raster_resolution},
          {"target_error", params.target_error}};
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
  tree.bytes =
      tree.nodes2 * sizeof(BvhNode2) + tree.nodes8 * sizeof(BvhNode8) + tree.references * sizeof(uint32_t);
  return tree;
}

SceneSummary summarize(const Scene& scene, const std::string& name, uint64_t hash) {
  return {name,
          hash,
          scene.triangles.size(),
          scene.positions.size(),
          scene.objects.size(),
          scene.degenerate_triangles,
          scene.repaired_triangles,
          scene.alpha_triangles,
          scene.single_sided_triangles};
}

std::string reportJson(const BakeReport& report) {
  Json cells = Json::array();
  for (const CellSummary& cell : report.cells) {
    Json json = cellToJson(cell.cell);
    addCellStatistics(json, cell, report.scene.triangles);
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
                       {"repair", report.repair}}},
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

std::string materialWarning(const SceneSummary& scene) {
  std::string what;
  if (scene.alpha != 0) what = fmt::format("{} triangles with alpha are traced as opaque", scene.alpha);
  if (scene.single_sided != 0) {
    what += fmt::format("{}{} single-sided triangles are traced as two-sided", what.empty() ? "" : "; ",
                        scene.single_sided);
  }
  return what;
}

uint64_t peakProcessBytes() {
  rusage usage = {};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return uint64_t(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace sightline
