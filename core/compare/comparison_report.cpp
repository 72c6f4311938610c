#include "core/compare/comparison_report.h"

#include <fmt/format.h>

#include "core/bake/report_json.h"
#include "core/base/text.h"
#include "core/io/csv.h"

namespace sightline {
namespace {

Json toJson(const Spread& spread) {
  return {{"low", spread.low}, {"median", spread.median}, {"high", spread.high}};
}

Json stateJson(const CurvePoint& state, double missing_share) {
  return {{"seconds", state.seconds},      {"rays", state.allRays()},
          {"rays_by_stage", state.rays},   {"new_by_stage", state.new_triangles},
          {"iteration", state.iteration},  {"triangles", state.size},
          {"missing_share", missing_share}};
}

Json runJson(const MethodRun& run) {
  Json json = {{"method", methodName(run.method)}, {"seed", run.seed}, {"stop", stopReasonName(run.stop)}};
  for (const ComparePoint& point : run.points) {
    Json p = {{"budget_share", point.budget_share}};
    p.update(stateJson(point.state, point.missing_share));
    p["average_wrong"] = point.error.averageWrong();
    p["max_wrong"] = point.error.max_wrong;
    p["average_regions"] = point.error.averageRegions();
    p["largest_region"] = point.error.largest_region;
    json["points"].push_back(p);
  }
  json["curve"] = Json::array();
  for (size_t i = 0; i < run.curve.size(); ++i) {
    json["curve"].push_back(stateJson(run.curve[i], run.missing_shares[i]));
  }
  return json;
}

/// Those that all methods share: of a method, and of the rays after a bake, there is none.
Json sharedParameters(const BakeParams& params) {
  Json json = toJson(params);
  json.erase("method");
  json.erase("validation_rays");
  return json;
}

Json summaryJson(const MethodSummary& s) {
  return {{"method", methodName(s.method)},
          {"average_wrong", toJson(s.average_wrong)},
          {"mean_max_wrong", toJson(s.mean_max_wrong)},
          {"max_wrong", s.max_wrong},
          {"average_regions", toJson(s.average_regions)},
          {"mean_largest_region", toJson(s.mean_largest_region)},
          {"missing_share", toJson(s.missing_share)},
          {"pvs_share", toJson(s.pvs_share)},
          {"rays", toJson(s.rays)},
          {"seconds", toJson(s.seconds)}};
}

}  // namespace

std::string comparisonTable(const ComparisonReport& report) {
  const CompareOptions& options = report.options;
  const auto summaries =
      summarize(report.cells, options, uint32_t(report.scene.triangles), options.points - 1);
  const auto spread = [&](const Spread& s, const char* format, double factor = 1) {
    const auto number = [&](double value) { return fmt::format(fmt::runtime(format), value * factor); };
    if (options.repeats == 1) return number(s.median);
    return fmt::format("{} ({}-{})", number(s.median), number(s.low), number(s.high));
  };
  std::string text = fmt::format("{:<8} {:>24} {:>22} {:>20} {:>16} {:>9} {:>8} {:>8} {:>12}\n", "method",
                                 "average wrong pixels", "largest of a cell", "wrong regions",
                                 "largest region", "rays", "seconds", "PVS", "missing/M");
  for (const MethodSummary& s : summaries) {
    text += fmt::format("{:<8} {:>24} {:>22} {:>20} {:>16} {:>9} {:>8.2f} {:>6.2f} % {:>12.4g}\n",
                        methodName(s.method), spread(s.average_wrong, "{:.3f}"),
                        spread(s.mean_max_wrong, "{:.1f}"), spread(s.average_regions, "{:.3f}"),
                        spread(s.mean_largest_region, "{:.1f}"), shortCount(uint64_t(s.rays.median)),
                        s.seconds.median, 100 * s.pvs_share.median, 1e6 * s.missing_share.median);
  }
  return text;
}

std::string comparisonJson(const ComparisonReport& report) {
  const CompareOptions& options = report.options;
  Json points = Json::array();
  for (size_t p = 0; p < options.points; ++p) {
    Json methods = Json::array();
    for (const auto& s : summarize(report.cells, options, uint32_t(report.scene.triangles), p)) {
      methods.push_back(summaryJson(s));
    }
    points.push_back(
        {{"budget_share", report.cells.front().runs.front().points[p].budget_share}, {"methods", methods}});
  }
  Json cells = Json::array();
  for (const CellComparison& cell : report.cells) {
    Json json = cellToJson(cell.cell, report.scene.offset);
    for (const MethodRun& run : cell.runs) json["runs"].push_back(runJson(run));
    cells.push_back(json);
  }
  const Json json = {{"sightline", report.version},
                     {"complete", report.complete},
                     {"command", report.command},
                     {"device", toJson(std::optional(report.device))},
                     {"scene", toJson(report.scene)},
                     {"spatial_splits", report.spatial_splits},
                     {"parameters", sharedParameters(options.params)},
                     {"seed", options.seed},
                     {"repeats", options.repeats},
                     {"missing_rays", options.missing_rays},
                     {"views",
                      {{"count", options.measure.views},
                       {"resolution", options.measure.resolution},
                       {"fov", options.measure.fov},
                       {"seed", options.measure.seed}}},
                     {"points", points},
                     {"cells", cells}};
  return jsonText(json);
}

std::string comparisonCsv(const ComparisonReport& report) {
  Csv csv({"cell", "method", "seed", "budget_share", "seconds", "rays", "random_rays", "border_rays",
           "reverse_rays", "triangles", "missing_share", "average_wrong", "max_wrong", "average_regions",
           "largest_region"});
  const auto number = [](auto value) { return fmt::format("{}", value); };
  for (const CellComparison& cell : report.cells) {
    for (const MethodRun& run : cell.runs) {
      for (const ComparePoint& p : run.points) {
        csv.row({cell.cell.name, methodName(run.method), number(run.seed), number(p.budget_share),
                 number(p.state.seconds), number(p.state.allRays()), number(p.state.rays[0]),
                 number(p.state.rays[1]), number(p.state.rays[2]), number(p.state.size),
                 number(p.missing_share), number(p.error.averageWrong()), number(p.error.max_wrong),
                 number(p.error.averageRegions()), number(p.error.largest_region)});
      }
    }
  }
  return csv.text();
}

}  // namespace sightline
