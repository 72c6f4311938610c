#include "core/bake/bake_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/bake/cell_table.h"
#include "core/base/text.h"
#include "core/io/csv.h"
#include "core/page/curve_range.h"
#include "core/pvs/param_table.h"
#include "core/pvs/stage_name.h"

namespace sightline {
namespace {

/// Cells whose growth is drawn a line each: of more, no line could be told from the others.
constexpr size_t kLineEach = 8;
/// Colour numbers of a chart of more: median and range of one colour, then the cells.
constexpr uint32_t kMedianColor = 0, kRangeColor = 10, kFirstCellColor = 11;
/// Cells whose iterations are drawn stage by stage: more would make a page that nobody scrolls through.
constexpr size_t kStageCharts = 12;
/// The thesis's example of a termination criterion: dots of figures 7.4 to 7.8.
constexpr uint32_t kExampleThreshold = 10;
/// The thesis's colours of the stages (figure 7.3), as numbers of the page's colours: red, blue, green.
constexpr uint32_t kStageColors[] = {1, 0, 2};

using Curve = std::vector<CurvePoint>;

/// The last point of each iteration.
Curve iterationEnds(const Curve& curve) {
  Curve ends;
  for (size_t i = 0; i < curve.size(); ++i) {
    if (i + 1 == curve.size() || curve[i].iteration != curve[i + 1].iteration) ends.push_back(curve[i]);
  }
  return ends;
}

/// Where T = 10 stops: the first iteration with fewer new triangles. Empty: none had fewer.
template <typename X>
std::vector<ChartPoint> exampleStop(const Curve& curve, X&& x) {
  uint32_t before = 0;
  for (const CurvePoint& end : iterationEnds(curve)) {
    if (end.size - before < kExampleThreshold) return {{x(end), double(end.size)}};
    before = end.size;
  }
  return {};
}

std::string exampleStopText() {
  return fmt::format("the first iteration with fewer than {0} new triangles, where T = {0} stops.",
                     kExampleThreshold);
}

size_t recorded(const std::vector<Curve>& curves) {
  return size_t(std::ranges::count_if(curves, [](const Curve& curve) { return !curve.empty(); }));
}

/// Adds a line a cell, and a dot where T = 10 stops.
template <typename X>
void addCells(ReportChart& chart, const BakeReport& report, const std::vector<Curve>& curves,
              uint32_t first_color, X&& x) {
  const bool on_demand = !chart.pick.empty();
  for (size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].empty()) continue;
    const auto color = uint32_t(first_color + i);
    ChartSeries line{.name = report.cells[i].cell.name, .on_demand = on_demand, .color = color};
    ChartSeries dot{.name = fmt::format("{}, T = {}", line.name, kExampleThreshold),
                    .points = exampleStop(curves[i], x),
                    .dots = true,
                    .on_demand = on_demand,
                    .in_legend = false,
                    .color = color};
    for (const CurvePoint& point : curves[i]) line.points.push_back({x(point), double(point.size)});
    chart.series.push_back(line);
    if (!dot.points.empty()) chart.series.push_back(dot);
  }
}

/// Adds the median of all cells and the range that they fill.
template <typename X>
void addRange(ReportChart& chart, const std::vector<Curve>& curves, X&& x) {
  std::vector<std::vector<ChartPoint>> lines;
  for (const Curve& curve : curves) {
    lines.emplace_back();
    for (const CurvePoint& point : curve) lines.back().push_back({x(point), double(point.size)});
  }
  CurveRange range = rangeOf(lines, {chart.log_x, chart.log_y});
  for (auto* line : {&range.median, &range.lowest, &range.highest}) {
    for (ChartPoint& point : *line) point.y = std::round(point.y);  // whole triangles
  }
  chart.series.push_back({.name = "median", .points = std::move(range.median), .color = kMedianColor});
  chart.series.push_back(
      {.name = "lowest", .points = std::move(range.lowest), .in_legend = false, .color = kRangeColor});
  chart.series.push_back(
      {.name = "highest", .points = std::move(range.highest), .fills = true, .color = kRangeColor});
}

/// The set's size over x(point): of few cells a line each, of many their median and range, and each on
/// demand.
template <typename X>
ReportChart sizeChart(const BakeReport& report, const std::vector<Curve>& curves, const std::string& x_name,
                      X&& x) {
  ReportChart chart{
      .title = "Set size over " + x_name, .x = x_name, .y = "triangles", .log_x = true, .log_y = true};
  if (recorded(curves) <= kLineEach) {
    chart.note = "Large dot: " + exampleStopText();
    addCells(chart, report, curves, 0, x);
    return chart;
  }
  chart.pick = "single cells";
  addRange(chart, curves, x);
  addCells(chart, report, curves, kFirstCellColor, x);
  return chart;
}

/// What each stage has done so far, over all rays. counts: member of CurvePoint.
ReportChart stageChart(const std::string& title, const std::string& y, const Curve& curve,
                       std::array<uint64_t, 3> CurvePoint::*counts) {
  ReportChart chart{.title = title, .x = "rays", .y = y, .log_x = true, .log_y = true};
  for (uint32_t stage = 0; stage < 3; ++stage) {
    ChartSeries line{.name = stageName(stage), .color = kStageColors[stage]};
    for (const CurvePoint& p : curve)
      line.points.push_back({double(p.allRays()), double((p.*counts)[stage])});
    if (!curve.empty() && (curve.back().*counts)[stage] > 0) chart.series.push_back(line);
  }
  return chart;
}

std::string shareText(double share) {
  return fmt::format("{:.2f} %", 100 * share);
}

ReportTable cellsTable(const BakeReport& report) {
  ReportTable table{.columns = {"cell", "triangles", "of the scene", "rays", "Mrays/s", "iterations",
                                "by random", "by border", "by reverse", "missing rays at most", "seconds",
                                "ended by"}};
  const bool bounded =
      std::ranges::any_of(report.cells, [](const auto& c) { return c.stats.bound_tests > 0; });
  const bool contains =
      std::ranges::any_of(report.cells, [](const auto& c) { return c.stats.contained_triangles > 0; });
  if (bounded) table.columns.push_back("error at most");
  if (contains) table.columns.push_back("contained");
  std::vector<std::string> warnings;
  for (size_t i = 0; i < report.cells.size(); ++i) warnings.push_back(verdictNames(warningsOf(report, i)));
  const bool warns = std::ranges::any_of(warnings, [](const auto& text) { return !text.empty(); });
  if (warns) table.columns.push_back("warnings");
  for (size_t i = 0; i < report.cells.size(); ++i) {
    const CellSummary& cell = report.cells[i];
    const CellStats& s = cell.stats;
    const double share =
        report.scene.triangles == 0 ? 0 : double(cell.pvs_size) / double(report.scene.triangles);
    table.rows.push_back(
        {cell.cell.name, std::to_string(cell.pvs_size), shareText(share), shortCount(cell.rays()),
         fmt::format("{:.2f}", cell.mraysPerSecond()), std::to_string(s.iterations),
         std::to_string(s.random.new_triangles), std::to_string(s.border.new_triangles),
         std::to_string(s.reverse.new_triangles),
         s.validation_rays == 0 ? "not measured" : fmt::format("{:.2g}", cell.missingBound()),
         fmt::format("{:.2f}", s.seconds), stopReasonName(s.stop)});
    if (bounded)
      table.rows.back().push_back(s.bound_tests > 0 ? fmt::format("{:.3g}", s.error_bound) : "not tested");
    if (contains) table.rows.back().push_back(std::to_string(s.contained_triangles));
    if (warns) table.rows.back().push_back(warnings[i]);
  }
  return table;
}

/// What of a scene and of a bake costs something, and was on.
std::vector<ReportFact> featureFacts(const BakeReport& report) {
  const SceneSummary& scene = report.scene;
  std::vector<ReportFact> facts;
  const auto add = [&](uint64_t count, const char* name, const char* of) {
    if (count != 0) facts.push_back({name, fmt::format("{} {}", count, of)});
  };
  add(scene.instances, "instances", "places of meshes that are stored once");
  add(scene.surfaces.masked, "alpha masks", "triangles with holes");
  add(scene.surfaces.glass, "glass", "triangles that are seen, and seen through");
  add(scene.surfaces.front_only, "sides", "triangles that are not there from behind");
  add(report.see_through.size(), "hiding nothing", "objects that are seen through");
  add(report.doors.size(), "doors", "objects that open: two sets a cell");
  if (report.params.smallest_hole > 0) {
    facts.push_back(
        {"smallest hole", fmt::format("{:.6g}: narrower gaps count as closed", report.params.smallest_hole)});
  }
  if (scene.offset != glm::dvec3(0.0)) {
    facts.push_back({"offset", fmt::format("({:.0f}, {:.0f}, {:.0f}), taken off all coordinates",
                                           scene.offset.x, scene.offset.y, scene.offset.z)});
  }
  if (facts.empty()) facts.push_back({"none", "all triangles are opaque, from both sides"});
  return facts;
}

std::vector<ReportFact> sceneFacts(const BakeReport& report) {
  const SceneSummary& scene = report.scene;
  std::vector<ReportFact> facts = {{"triangles", std::to_string(scene.triangles)},
                                   {"vertices", std::to_string(scene.vertices)},
                                   {"objects", std::to_string(scene.objects)},
                                   {"instances", std::to_string(scene.instances)},
                                   {"triangles stored", std::to_string(scene.stored_triangles)},
                                   {"hash of the scene", hashText(scene.hash)},
                                   {"hash of all sets", hashText(hashResult(report.cells))}};
  for (const std::string& warning : sceneWarnings(scene)) facts.push_back({"note", warning});
  return facts;
}

/// What is said against cells, in full, below their table.
void addWarnings(HtmlReport& html, const BakeReport& report) {
  ReportTable table{.caption = "Cells that may not be meant so",
                    .columns = {"cell", "what there is to say"},
                    .text_columns = 2};
  for (size_t i = 0; i < report.cells.size(); ++i) {
    for (const CellWarning& warning : warningsOf(report, i)) {
      table.rows.push_back({report.cells[i].cell.name, warning.text});
    }
  }
  if (!table.rows.empty()) html.table(table);
}

/// Triangles that only gaps let through, a row a cell that has some.
void addLeaks(HtmlReport& html, const BakeReport& report) {
  ReportTable table{.caption = "Leaks: seen only through narrow gaps",
                    .columns = {"cell", "narrower than", "triangles", "of the set", "a place"}};
  for (size_t i = 0; i < report.leaks.size(); ++i) {
    if (!report.leaks[i] || report.leaks[i]->triangles == 0) continue;
    const Leaks& leaks = *report.leaks[i];
    table.rows.push_back(
        {report.cells[i].cell.name, fmt::format("{:.3g}", leaks.width), std::to_string(leaks.triangles),
         shareText(double(leaks.triangles) / std::max(1u, report.cells[i].pvs_size)),
         fmt::format("({:.6g}, {:.6g}, {:.6g})", leaks.place.x, leaks.place.y, leaks.place.z)});
  }
  if (!table.rows.empty()) html.table(table);
}

/// What is seen, what is proved hidden, and what is neither.
void addStates(HtmlReport& html, const BakeReport& report) {
  if (report.bounds.empty()) return;
  ReportTable table{.caption = "Within the bound",
                    .columns = {"cell", "seen", "open", "proved hidden", "of what is not seen"}};
  for (size_t i = 0; i < report.cells.size(); ++i) {
    const uint64_t seen = report.cells[i].pvs_size, hidden = report.scene.triangles - report.bounds[i];
    table.rows.push_back(
        {report.cells[i].cell.name, std::to_string(seen), std::to_string(report.bounds[i] - seen),
         std::to_string(hidden),
         shareText(double(hidden) / double(std::max<uint64_t>(1, report.scene.triangles - seen)))});
  }
  html.table(table);
}

/// What the doors' opening adds to each cell's set.
void addDoors(HtmlReport& html, const BakeReport& report) {
  if (report.doors.empty()) return;
  html.section("Doors");
  std::string names;
  for (const NamedTriangles& door : report.doors) names += (names.empty() ? "" : ", ") + door.name;
  html.text(fmt::format("{}: {}. Closed, they are part of the sets above; open, they hide nothing.",
                        counted(report.doors.size(), "object"), names));
  ReportTable table{.columns = {"cell", "closed", "open adds", "open", "rays", "seconds"}};
  for (const CellSummary& cell : report.cells) {
    if (!cell.open_stats) continue;
    const CellStats& open = *cell.open_stats;
    table.rows.push_back({cell.cell.name, std::to_string(cell.pvs_size), std::to_string(cell.open_added),
                          std::to_string(cell.pvs_size + cell.open_added),
                          shortCount(open.random.rays + open.border.rays + open.reverse.rays),
                          fmt::format("{:.2f}", open.seconds)});
  }
  html.table(table);
}

void addGrowth(HtmlReport& html, const BakeReport& report, const std::vector<Curve>& curves) {
  html.section("How the sets grew");
  const size_t earlier = report.cells.size() - recorded(curves);
  if (earlier > 0) {
    html.text(fmt::format("{} of {} {} baked by an earlier run, which left no curve.", earlier,
                          counted(report.cells.size(), "cell"), report.cells.size() == 1 ? "was" : "were"));
  }
  if (recorded(curves) == 0) return;
  if (recorded(curves) > kLineEach) {
    html.text(
        fmt::format("Line: median. Band: from the smallest to the largest of the {} cells, none left out, "
                    "from where all have "
                    "begun; a cell that has ended counts with its last size. Large dot of a single cell: {}",
                    recorded(curves), exampleStopText()));
  }
  html.charts({sizeChart(report, curves, "rays", [](const CurvePoint& p) { return double(p.allRays()); }),
               sizeChart(report, curves, "seconds", [](const CurvePoint& p) { return p.seconds; })});
}

void addPictures(HtmlReport& html, const BakeReport& report, const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return;
  html.section("Pictures");
  const SurfaceCounts& surfaces = report.scene.surfaces;
  std::string text =
      "From outside: triangles in the set green, the view cell orange. From inside: red what is seen but not "
      "in the set.";
  if (surfaces.masked != 0) text += " Through holes one sees what is behind.";
  if (surfaces.glass != 0 || !report.see_through.empty() || !report.doors.empty()) {
    text += " Glass tints what is behind it, bluish.";
  }
  if (!report.see_through.empty()) text += " What hides nothing is drawn as glass.";
  if (!report.doors.empty()) text += " Doors that are open are drawn as glass.";
  html.text(text);
  html.pictures(pictures);
}

void addStages(HtmlReport& html, const BakeReport& report, const std::vector<Curve>& curves) {
  if (recorded(curves) == 0) return;
  html.section("Stage by stage");
  html.text("Rays that each stage has traced, and triangles that it has found, over the rays of all stages.");
  std::vector<ReportChart> charts;
  for (size_t i = 0; i < curves.size() && charts.size() < 2 * kStageCharts; ++i) {
    if (curves[i].empty()) continue;
    const std::string& name = report.cells[i].cell.name;
    charts.push_back(stageChart(name + ": rays by stage", "rays of the stage", curves[i], &CurvePoint::rays));
    charts.push_back(
        stageChart(name + ": new triangles by stage", "triangles", curves[i], &CurvePoint::new_triangles));
  }
  if (charts.size() / 2 < recorded(curves)) {
    html.text(fmt::format("The first {} of {} cells are drawn; the table of bake --csv has all of them.",
                          kStageCharts, recorded(curves)));
  }
  html.charts(charts);
}

}  // namespace

std::vector<ReportFact> parameterFacts(const BakeParams& params) {
  std::vector<ReportFact> facts;
  for (const ParamGroup group : kParamGroups) {
    for (const Param& param : kParams) {
      if (param.group != group || !isUsedBy(param, params.method)) continue;
      const bool drawn = params.method == Method::kRaster && param.name == std::string_view("n_rand");
      facts.push_back({drawn ? "samples an iteration" : param.label, shownText(param, params)});
    }
  }
  return facts;
}

HtmlReport bakePage(const BakeReport& report, const BakePage& page) {
  HtmlReport html("Bake of " + report.scene.name);
  html.text(fmt::format("Which of {} triangles can be seen from {} of {}, by {} on {}.",
                        report.scene.triangles, report.cells.size(),
                        counted(report.planned_cells, "view cell"), methodName(report.params.method),
                        report.baked_on));
  html.section("Cells");
  html.table(cellsTable(report));
  html.text(
      std::string(
          "Missing rays at most: upper end of the 95 % interval of the share of fresh random rays that hit a "
          "triangle outside the set.") +
      (report.params.target_error > 0 ? " Error at most: the same of wrong pixels." : ""));
  addWarnings(html, report);
  addLeaks(html, report);
  addStates(html, report);
  addDoors(html, report);
  addGrowth(html, report, page.curves);
  addPictures(html, report, page.pictures);
  addStages(html, report, page.curves);
  html.section("Parameters");
  html.facts(parameterFacts(report.params));
  html.section("Scene");
  html.facts(sceneFacts(report));
  html.section("Features that were on");
  html.facts(featureFacts(report));
  html.repeat({.command = page.command,
               .seed = std::to_string(report.params.seed),
               .device = report.device ? report.device->id + ", " + report.device->name : report.baked_on,
               .driver = report.device ? report.device->driver : "",
               .version = report.version});
  return html;
}

namespace {

/// Where a cell's bake ended, by its statistics. Its validation takes no part in a curve's seconds.
CurvePoint endOf(const CellStats& s) {
  CurvePoint end{s.random.seconds + s.border.seconds + s.reverse.seconds,
                 {s.random.rays, s.border.rays, s.reverse.rays},
                 {s.random.new_triangles, s.border.new_triangles, s.reverse.new_triangles},
                 0,
                 s.iterations};
  for (const uint64_t found : end.new_triangles) end.size += uint32_t(found);
  return end;
}

}  // namespace

std::string curvesCsv(const BakeReport& report, const std::vector<Curve>& curves) {
  Csv csv({"cell", "iteration", "seconds", "random_rays", "border_rays", "reverse_rays", "random_new",
           "border_new", "reverse_new", "triangles"});
  for (size_t i = 0; i < curves.size(); ++i) {
    const Curve end = {endOf(report.cells[i].stats)};
    for (const CurvePoint& p : curves[i].empty() ? end : curves[i]) {
      std::vector<std::string> row = {report.cells[i].cell.name, std::to_string(p.iteration),
                                      fmt::format("{}", p.seconds)};
      for (const uint64_t rays : p.rays) row.push_back(std::to_string(rays));
      for (const uint64_t found : p.new_triangles) row.push_back(std::to_string(found));
      row.push_back(std::to_string(p.size));
      csv.row(row);
    }
  }
  return csv.text();
}

}  // namespace sightline
