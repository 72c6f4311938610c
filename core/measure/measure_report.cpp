#include "core/measure/measure_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/text.h"
#include "core/io/csv.h"

namespace sightline {
namespace {

Json errorJson(const PixelError& error) {
  return {{"average_wrong", error.averageWrong()},     {"max_wrong", error.max_wrong},
          {"average_regions", error.averageRegions()}, {"max_regions", error.max_regions},
          {"largest_region", error.largest_region},    {"wrong_pixels", error.wrong},
          {"wrong_share", error.wrongShare()},         {"worst_view", error.worst_view}};
}

Json sceneJson(const SceneError& scene) {
  return {{"average_wrong", scene.average_wrong},   {"max_wrong", scene.max_wrong},
          {"mean_max_wrong", scene.mean_max_wrong}, {"average_regions", scene.average_regions},
          {"largest_region", scene.largest_region}, {"mean_largest_region", scene.mean_largest_region},
          {"wrong_share", scene.wrong_share}};
}

Json setJson(const MeasuredSet& set) {
  Json cells = Json::array();
  for (const MeasuredCell& cell : set.cells) {
    Json json = {{"name", cell.cell}, {"pvs_size", cell.pvs_size}};
    json.update(errorJson(cell.error));
    json["worst_views"] = cell.worst_views;
    json["pictures"] = cell.pictures;
    cells.push_back(json);
  }
  return {
      {"file", set.file},        {"baked_on", set.baked_on},        {"method", methodName(set.params.method)},
      {"seed", set.params.seed}, {"scene", sceneJson(set.scene())}, {"cells", cells}};
}

std::string tableLine(const std::string& name, size_t width, const std::string& pvs_size, double average,
                      uint32_t max, double regions, uint32_t largest, double share) {
  return fmt::format("{:<{}}  {:>10}  {:>10.4g}  {:>10}  {:>11.4g}  {:>14}  {:>11.3g}\n", name, width,
                     pvs_size, average, max, regions, largest, share);
}

}  // namespace

SceneError MeasuredSet::scene() const {
  std::vector<PixelError> errors;
  for (const MeasuredCell& cell : cells) errors.push_back(cell.error);
  return summarize(errors);
}

std::string measureTable(const MeasureReport& report) {
  size_t width = 9;  // "all cells"
  for (const MeasuredSet& set : report.sets) {
    for (const MeasuredCell& cell : set.cells) width = std::max(width, cell.cell.size());
  }
  std::string table;
  for (const MeasuredSet& set : report.sets) {
    if (set.cells.empty()) continue;  // stopped in the first
    table += fmt::format(
        "{}\n{:<{}}   triangles   avg error   max error  avg regions  largest region  wrong "
        "share\n",
        set.file, "cell", width);
    for (const MeasuredCell& cell : set.cells) {
      const PixelError& e = cell.error;
      table += tableLine(cell.cell, width, std::to_string(cell.pvs_size), e.averageWrong(), e.max_wrong,
                         e.averageRegions(), e.largest_region, e.wrongShare());
    }
    const SceneError scene = set.scene();
    table += tableLine("all cells", width, "", scene.average_wrong, scene.max_wrong, scene.average_regions,
                       scene.largest_region, scene.wrong_share);
  }
  return table;
}

Json measureJson(const MeasureReport& report) {
  Json sets = Json::array();
  for (const MeasuredSet& set : report.sets) sets.push_back(setJson(set));
  return {{"sightline", report.version},
          {"complete", report.complete},
          {"scene",
           {{"name", report.scene.name},
            {"hash", hashText(report.scene.hash)},
            {"triangles", report.scene.triangles}}},
          {"device",
           {{"id", report.device.id},
            {"name", report.device.name},
            {"driver", report.device.driver},
            {"layout", report.device.layout}}},
          {"views", report.options.views},
          {"resolution", report.options.resolution},
          {"seed", report.options.seed},
          {"fov", report.options.fov},
          {"rays", report.rays},
          {"seconds", report.seconds},
          {"sets", sets}};
}

std::string measureCsv(const MeasureReport& report) {
  Csv csv({"file", "method", "cell", "pvs_size", "average_wrong", "max_wrong", "average_regions",
           "max_regions", "largest_region", "wrong_pixels", "wrong_share", "worst_view"});
  for (const MeasuredSet& set : report.sets) {
    for (const MeasuredCell& cell : set.cells) {
      const PixelError& e = cell.error;
      csv.row({set.file, methodName(set.params.method), cell.cell, fmt::format("{}", cell.pvs_size),
               fmt::format("{}", e.averageWrong()), fmt::format("{}", e.max_wrong),
               fmt::format("{}", e.averageRegions()), fmt::format("{}", e.max_regions),
               fmt::format("{}", e.largest_region), fmt::format("{}", e.wrong),
               fmt::format("{}", e.wrongShare()), fmt::format("{}", e.worst_view)});
    }
  }
  return csv.text();
}

std::vector<std::string> pastLimits(const MeasureReport& report, double max_average, double max_wrong) {
  std::vector<std::string> lines;
  for (const MeasuredSet& set : report.sets) {
    for (const MeasuredCell& cell : set.cells) {
      const std::string where = set.file + ", " + cell.cell;
      if (cell.error.averageWrong() > max_average) {
        lines.push_back(fmt::format("{}: {:.4g} wrong pixels a view, at most {:g} allowed", where,
                                    cell.error.averageWrong(), max_average));
      }
      if (cell.error.max_wrong > max_wrong) {
        lines.push_back(fmt::format("{}: {} wrong pixels in view {}, at most {:g} allowed", where,
                                    cell.error.max_wrong, cell.error.worst_view, max_wrong));
      }
    }
  }
  return lines;
}

}  // namespace sightline
