#include "core/measure/measure_page.h"

#include <fmt/format.h>

#include "core/base/text.h"

namespace sightline {
namespace {

std::string shareOf(uint64_t size, uint64_t triangles) {
  return fmt::format("{:.2f} %", triangles == 0 ? 0.0 : 100 * double(size) / double(triangles));
}

/// One line a file, averages over its cells.
ReportTable filesTable(const MeasureReport& report) {
  ReportTable table{.caption = "Averages over cells, in pixels of a view",
                    .columns = {"file", "method", "seed", "avg error", "max error, mean of cells",
                                "avg regions", "largest region, mean of cells", "in the set"}};
  table.text_columns = 2;
  for (const MeasuredSet& set : report.sets) {
    const SceneError error = set.scene();
    double size = 0;
    for (const MeasuredCell& cell : set.cells) size += double(cell.pvs_size) / double(set.cells.size());
    table.rows.push_back(
        {set.file, methodName(set.params.method), std::to_string(set.params.seed),
         fmt::format("{:.4g}", error.average_wrong), fmt::format("{:.4g}", error.mean_max_wrong),
         fmt::format("{:.4g}", error.average_regions), fmt::format("{:.4g}", error.mean_largest_region),
         shareOf(uint64_t(size), report.scene.triangles)});
  }
  return table;
}

ReportTable cellsTable(const MeasureReport& report) {
  ReportTable table{.columns = {"cell", "file", "triangles", "of the scene", "avg error", "max error",
                                "avg regions", "largest region", "wrong share"}};
  table.text_columns = 2;
  const size_t cells = report.sets.empty() ? 0 : report.sets.front().cells.size();
  for (size_t c = 0; c < cells; ++c) {
    for (const MeasuredSet& set : report.sets) {
      if (c >= set.cells.size()) continue;
      const MeasuredCell& cell = set.cells[c];
      table.rows.push_back(
          {cell.cell, set.file, std::to_string(cell.pvs_size), shareOf(cell.pvs_size, report.scene.triangles),
           fmt::format("{:.4g}", cell.error.averageWrong()), std::to_string(cell.error.max_wrong),
           fmt::format("{:.4g}", cell.error.averageRegions()), std::to_string(cell.error.largest_region),
           fmt::format("{:.3g}", cell.error.wrongShare())});
    }
  }
  return table;
}

/// A number of each cell, a series a file.
template <typename Value>
ReportChart cellsChart(const MeasureReport& report, const std::string& title, Value&& value) {
  ReportChart chart{.title = title,
                    .note = "Cells in the order of their file. A cell without an error has no dot.",
                    .x = "cell",
                    .y = "wrong pixels",
                    .log_y = true};
  for (const MeasuredSet& set : report.sets) {
    ChartSeries series{.name = set.file, .dots = true};
    for (size_t c = 0; c < set.cells.size(); ++c)
      series.points.push_back({double(c + 1), value(set.cells[c].error)});
    chart.series.push_back(series);
  }
  return chart;
}

}  // namespace

std::string worstViewCaption(const MeasuredSet& set, const MeasuredCell& cell, size_t index) {
  const uint32_t view = cell.worst_views[index];
  const std::string wrong =
      view == cell.error.worst_view ? ", " + counted(cell.error.max_wrong, "wrong pixel") : "";
  return fmt::format("{}, {}: view {}{}", cell.cell, set.file, view, wrong);
}

HtmlReport measurePage(const MeasureReport& report, std::span<const ReportPicture> pictures,
                       const std::string& command) {
  const MeasureOptions& options = report.options;
  HtmlReport page("Pixel error in " + report.scene.name);
  page.text(fmt::format(
      "{} views of {} x {} pixels from each view cell. A pixel is wrong if it shows a triangle that "
      "is not in the cell's set; a region is a group of wrong pixels that touch.{}",
      options.views, options.resolution, options.resolution,
      report.complete ? "" : " Stopped before all cells were measured."));
  page.section("Files");
  page.table(filesTable(report));
  page.section("Cells");
  page.table(cellsTable(report));
  if (!report.sets.empty() && report.sets.front().cells.size() > 1) {
    page.charts(
        {cellsChart(report, "Average error", [](const PixelError& e) { return e.averageWrong(); }),
         cellsChart(report, "Maximum error", [](const PixelError& e) { return double(e.max_wrong); })});
  }
  if (!pictures.empty()) {
    page.section("Worst views");
    page.text("The scene grey, wrong pixels red.");
    page.pictures(pictures);
  }
  page.section("Scene and views");
  page.facts({{"triangles", std::to_string(report.scene.triangles)},
              {"views a cell", std::to_string(options.views)},
              {"pixels a side", std::to_string(options.resolution)},
              {"field of view", fmt::format("{:g} degrees", options.fov)},
              {"rays", std::to_string(report.rays)}});
  page.repeat({.command = command,
               .seed = std::to_string(options.seed),
               .device = report.device.id + ", " + report.device.name,
               .driver = report.device.driver,
               .version = report.version});
  return page;
}

}  // namespace sightline
