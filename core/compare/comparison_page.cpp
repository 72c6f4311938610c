#include <fmt/format.h>

#include "core/bake/bake_page.h"
#include "core/base/text.h"
#include "core/compare/comparison_report.h"

namespace sightline {
namespace {

/// Cells whose curves are drawn one by one: more would make a page that nobody scrolls through.
constexpr size_t kDrawnCells = 10;

std::string spreadText(const Spread& spread, const char* format, bool several, double factor = 1) {
  const auto number = [&](double value) { return fmt::format(fmt::runtime(format), value * factor); };
  if (!several) return number(spread.median);
  return fmt::format("{}\n({} to {})", number(spread.median), number(spread.low), number(spread.high));
}

ReportTable summaryTable(const ComparisonReport& report, const std::vector<MethodSummary>& summaries) {
  const bool several = report.options.repeats > 1;
  ReportTable table{.columns = {"method", "average wrong pixels", "most wrong pixels, mean of cells",
                                "most wrong pixels", "wrong regions", "largest region, mean of cells",
                                "rays a cell", "seconds a cell", "set, of the scene",
                                "missing rays, in a million"}};
  for (const MethodSummary& s : summaries) {
    table.rows.push_back({methodName(s.method), spreadText(s.average_wrong, "{:.3f}", several),
                          spreadText(s.mean_max_wrong, "{:.1f}", several), std::to_string(s.max_wrong),
                          spreadText(s.average_regions, "{:.3f}", several),
                          spreadText(s.mean_largest_region, "{:.1f}", several),
                          shortCount(uint64_t(s.rays.median)), fmt::format("{:.3f}", s.seconds.median),
                          fmt::format("{:.2f} %", 100 * s.pvs_share.median),
                          spreadText(s.missing_share, "{:.3g}", several, 1e6)});
  }
  return table;
}

/// A value of the methods' summaries at all points over x, a line a method.
template <typename X, typename Y>
ReportChart summaryChart(const std::vector<std::vector<MethodSummary>>& points, const std::string& title,
                         const std::string& x_name, const std::string& y_name, X&& x, Y&& y) {
  ReportChart chart{.title = title, .x = x_name, .y = y_name, .log_x = true, .log_y = true};
  for (size_t m = 0; m < points.front().size(); ++m) {
    ChartSeries line{.name = methodName(points.front()[m].method), .color = uint32_t(m)};
    for (const auto& summaries : points) line.points.push_back({x(summaries[m]), y(summaries[m])});
    chart.series.push_back(line);
  }
  return chart;
}

/// Curves of a cell, a line a method (first seed).
template <typename X, typename Y>
ReportChart cellChart(const ComparisonReport& report, const CellComparison& cell, const std::string& title,
                      const std::string& x_name, const std::string& y_name, X&& x, Y&& y) {
  ReportChart chart{.title = title, .x = x_name, .y = y_name, .log_x = true, .log_y = true};
  for (size_t m = 0; m < report.options.methods.size(); ++m) {
    const MethodRun& run = cell.runs[m * report.options.repeats];
    ChartSeries line{.name = methodName(run.method), .color = uint32_t(m)};
    for (size_t i = 0; i < run.curve.size(); ++i) line.points.push_back({x(run.curve[i]), y(run, i)});
    chart.series.push_back(line);
  }
  return chart;
}

void addErrorCharts(HtmlReport& html, const std::vector<std::vector<MethodSummary>>& points) {
  const auto rays = [](const MethodSummary& s) { return s.rays.median; };
  const auto seconds = [](const MethodSummary& s) { return s.seconds.median; };
  const auto average = [](const MethodSummary& s) { return s.average_wrong.median; };
  const auto largest = [](const MethodSummary& s) { return s.mean_max_wrong.median; };
  const auto regions = [](const MethodSummary& s) { return s.average_regions.median; };
  const auto region = [](const MethodSummary& s) { return s.mean_largest_region.median; };
  html.section("Error over the budget");
  html.text(
      "Mean of all cells, median of the seeds. No error at all has no place on a logarithmic axis: there a "
      "line ends.");
  html.charts(
      {summaryChart(points, "Average error over rays", "rays", "wrong pixels", rays, average),
       summaryChart(points, "Average error over seconds", "seconds", "wrong pixels", seconds, average),
       summaryChart(points, "Maximum error over rays", "rays", "wrong pixels", rays, largest),
       summaryChart(points, "Maximum error over seconds", "seconds", "wrong pixels", seconds, largest),
       summaryChart(points, "Wrong regions over rays", "rays", "regions of a view", rays, regions),
       summaryChart(points, "Largest region over rays", "rays", "pixels", rays, region)});
}

void addCellCharts(HtmlReport& html, const ComparisonReport& report) {
  const auto rays = [](const CurvePoint& p) { return double(p.allRays()); };
  const auto seconds = [](const CurvePoint& p) { return p.seconds; };
  const auto size = [](const MethodRun& run, size_t i) { return double(run.curve[i].size); };
  const auto missing = [](const MethodRun& run, size_t i) { return run.missing_shares[i]; };
  html.section("Cell by cell");
  html.text("The first seed. Missing: share of fresh random rays that hit a triangle outside the set.");
  std::vector<ReportChart> charts;
  for (size_t c = 0; c < std::min(report.cells.size(), kDrawnCells); ++c) {
    const CellComparison& cell = report.cells[c];
    const std::string& name = cell.cell.name;
    charts.push_back(cellChart(report, cell, name + ": set over rays", "rays", "triangles", rays, size));
    charts.push_back(
        cellChart(report, cell, name + ": set over seconds", "seconds", "triangles", seconds, size));
    charts.push_back(
        cellChart(report, cell, name + ": missing rays over rays", "rays", "share", rays, missing));
    charts.push_back(
        cellChart(report, cell, name + ": missing rays over seconds", "seconds", "share", seconds, missing));
  }
  if (report.cells.size() > kDrawnCells) {
    html.text(fmt::format("The first {} of {} cells are drawn.", kDrawnCells, report.cells.size()));
  }
  html.charts(charts);
}

/// Parameters that all methods share: of a method, and of the rays after a bake, there is none.
std::vector<ReportFact> sharedFacts(const BakeParams& params) {
  std::vector<ReportFact> facts = parameterFacts(params);
  std::erase_if(facts,
                [](const ReportFact& f) { return f.first == "method" || f.first == "validation rays"; });
  return facts;
}

std::string budgetText(const BakeParams& params) {
  std::string text;
  if (params.max_rays > 0) text = shortCount(params.max_rays) + " rays";
  if (params.max_seconds > 0)
    text += fmt::format("{}{} seconds", text.empty() ? "" : " or ", params.max_seconds);
  return text;
}

}  // namespace

HtmlReport comparisonPage(const ComparisonReport& report) {
  const CompareOptions& options = report.options;
  std::vector<std::vector<MethodSummary>> points;
  for (size_t p = 0; p < options.points; ++p) {
    points.push_back(summarize(report.cells, options, uint32_t(report.scene.triangles), p));
  }
  HtmlReport html("Methods on " + report.scene.name);
  html.text(fmt::format("{} with {} a cell each, on {} of {} triangles; {} views of {} by {} pixels a cell.",
                        counted(options.methods.size(), "method"), budgetText(options.params),
                        counted(report.cells.size(), "cell"), report.scene.triangles, options.measure.views,
                        options.measure.resolution, options.measure.resolution));
  if (!report.complete) html.text("Stopped before all cells were compared: these are the first of them.");
  html.section("At the whole budget");
  html.table(summaryTable(report, points.back()));
  if (options.repeats > 1) {
    html.text(
        fmt::format("Median of {} seeds, in brackets from the lowest to the highest.", options.repeats));
  }
  addErrorCharts(html, points);
  addCellCharts(html, report);
  html.section("Parameters");
  html.facts(sharedFacts(options.params));
  html.repeat({.command = report.command,
               .seed = std::to_string(options.seed),
               .device = report.device.id + ", " + report.device.name,
               .driver = report.device.driver,
               .version = report.version});
  return html;
}

}  // namespace sightline
