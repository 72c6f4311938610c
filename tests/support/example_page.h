#pragma once
#include <cmath>
#include <string>

#include "core/page/html_report.h"
#include "core/picture/png.h"

namespace sightline::testing_support {

/// Ends a script, a comment, a tag, an attribute and a style, were it not escaped.
inline const std::string kHostileName =
    "</script><script>window.broken=1</script><!-- ]]> \"'><img src=x onerror=window.broken=2>&lt;</style>{{";

inline ReportChart exampleChart(const std::string& title, bool log, size_t series, size_t points) {
  ReportChart chart{.title = title, .x = "rays", .y = "triangles", .log_x = log, .log_y = log};
  for (size_t s = 0; s < series; ++s) {
    ChartSeries line{.name = "street-" + std::to_string(s + 1), .dashed = s % 3 == 1};
    for (size_t i = 0; i < points; ++i) {
      const double x = 1e6 * std::pow(1.03, double(i));
      line.points.push_back({x, double(200 * (s + 1)) * std::log(x / 5e5) + double(i % 7)});
    }
    chart.series.push_back(line);
  }
  return chart;
}

/// A page with everything that one can hold, and hostile names everywhere.
inline HtmlReport examplePage() {
  HtmlReport page("Bake of " + kHostileName);
  page.text("What can be seen from the cells of " + kHostileName);
  page.section("Parameters");
  page.facts({{"n_rand", "10000000"}, {kHostileName, "1"}, {"seed", kHostileName}});
  page.section("Cells");
  ReportTable table{
      .caption = "By cell; " + kHostileName,
      .columns = {"cell", "triangles", "share", "rays", "random", "border", "reverse", "seconds"}};
  for (int i = 0; i < 12; ++i) {
    table.rows.push_back(
        {"street-" + std::to_string(i), "123456", "2.71 %", "123M", "100000", "23000", "456", "9.8"});
  }
  table.rows.push_back({kHostileName, kHostileName, "", "", "", "", "", ""});
  page.table(table);
  page.section("Convergence " + kHostileName);
  ReportChart lines = exampleChart("Set size over rays", true, 4, 150);
  lines.note = "A dot: where T = 10 stops.";
  lines.series.push_back(
      {.name = "T = 10", .points = {{2e7, 900}}, .dots = true, .in_legend = false, .color = 1});
  lines.series.push_back({.name = kHostileName, .points = {{1e6, 10}, {3e6, 0}, {1e7, 1000}, {0, 5}}});
  page.charts({lines, exampleChart("Linear axes", false, 10, 30), exampleChart("Empty", true, 0, 0)});
  page.section("Pictures");
  Image image(320, 240, {40, 160, 60});
  for (uint32_t i = 0; i < 240; ++i) image.at(i, i) = {255, 0, 0};
  page.pictures({{.png = encodePng(image), .caption = kHostileName, .alt = kHostileName},
                 {.png = encodePng(image), .caption = "from inside", .alt = "a red line over green"}});
  page.repeat(
      {.command = "sightline bake '" + kHostileName + "' --cells cells.json -o out.pvs --html out.html",
       .seed = "1",
       .device = "cpu",
       .driver = "built in",
       .version = "1.2.3"});
  return page;
}

}  // namespace sightline::testing_support
