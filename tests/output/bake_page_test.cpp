#include "core/bake/bake_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "tests/output/example_pvs.h"
#include "tests/support/count_of.h"
#include "tests/support/example_page.h"

namespace sightline {
namespace {

using testing_support::countOf;
using testing_support::kHostileName;

BakeReport hostileReport() {
  BakeReport report;
  report.version = "1.2.3";
  report.scene.name = "room-" + kHostileName + ".obj";
  report.scene.triangles = 1000;
  report.baked_on = "cpu";
  report.cells = summarize(examplePvs());
  report.cells[1].cell.name = kHostileName + ",\n\"";
  report.planned_cells = 3;
  return report;
}

/// Two batches an iteration; the second iteration finds 9 triangles, the third 1.
std::vector<CurvePoint> exampleCurve() {
  return {{0.25, {1000, 0, 0}, {100, 0, 0}, 100, 1},
          {0.5, {1000, 500, 0}, {100, 50, 0}, 150, 1},
          {0.75, {2000, 500, 0}, {105, 50, 0}, 155, 2},
          {1.0, {2000, 600, 0}, {105, 54, 0}, 159, 2},
          {1.25, {3000, 600, 0}, {106, 54, 0}, 160, 3}};
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const size_t at = text.find(begin);
  if (at == std::string::npos) return "no " + begin;
  return text.substr(at, text.find(end, at) - at);
}

TEST(BakePage, DrawsTheCurvesAndWhereTenWouldStop) {
  BakePage page;
  page.curves = {exampleCurve(), {}};
  const std::string html = bakePage(hostileReport(), page).html();
  const std::string rays = between(html, "<b>Set size over rays</b>", "</figure>");
  EXPECT_NE(rays.find("<tr><td>1000</td><td>100</td></tr>\n<tr><td>1500</td><td>150</td></tr>\n"
                      "<tr><td>2500</td><td>155</td></tr>\n<tr><td>2600</td><td>159</td></tr>\n"
                      "<tr><td>3600</td><td>160</td></tr>\n</tbody>"),
            std::string::npos)
      << rays;
  EXPECT_NE(rays.find("a, T = 10</th></tr>\n<tr><td>2600</td><td>159</td></tr>\n</tbody>"), std::string::npos)
      << rays;
  const std::string seconds = between(html, "<b>Set size over seconds</b>", "</figure>");
  EXPECT_NE(seconds.find("<tr><td>1.25</td><td>160</td></tr>"), std::string::npos) << seconds;
  const std::string stages = between(html, "<b>a: new triangles by stage</b>", "</figure>");
  EXPECT_NE(stages.find(">border<"), std::string::npos);
  EXPECT_EQ(stages.find(">reverse<"), std::string::npos) << "it found nothing";
  EXPECT_NE(html.find("1 of 2 cells were baked by an earlier run"), std::string::npos);
}

/// A report of so many cells, and a page with a curve of each: cell i has i times the triangles of the first.
std::string pageOfCells(uint32_t cells) {
  BakeReport report = hostileReport();
  BakePage page;
  for (uint32_t i = 1; i <= cells; ++i) {
    report.cells.resize(i, report.cells[0]);
    report.cells[i - 1].cell.name = "cell-" + std::to_string(i);
    page.curves.push_back(exampleCurve());
    for (CurvePoint& p : page.curves.back()) p.size *= i;
  }
  page.pictures.push_back({.png = {1}, .caption = "cell-1 from outside"});
  return bakePage(report, page).html();
}

TEST(BakePage, FewCellsAreALineEach) {
  const std::string rays = between(pageOfCells(8), "<b>Set size over rays</b>", "</figure>");
  EXPECT_EQ(countOf(rays, "<tbody"), 8u + 8u) << "lines, and dots where fewer than 10 are new";
  EXPECT_EQ(countOf(rays, "data-on-demand"), 0u);
  EXPECT_EQ(rays.find("median"), std::string::npos);
}

TEST(BakePage, ManyCellsAreAMedianAndARangeWithSingleCellsOnDemand) {
  const std::string html = pageOfCells(50);
  EXPECT_NE(html.find("from the smallest to the largest of the 50 cells"), std::string::npos);
  for (const char* over : {"rays", "seconds"}) {
    SCOPED_TRACE(over);
    const std::string chart = between(html, std::string("<b>Set size over ") + over + "</b>", "</figure>");
    EXPECT_EQ(countOf(chart, "data-fills"), 1u);
    for (int cell = 1; cell <= 50; ++cell) {
      const std::string body = "<tbody[^>]*data-on-demand>\n[^\n]*>cell-" + std::to_string(cell) + "<";
      EXPECT_TRUE(std::regex_search(chart, std::regex(body))) << cell;
    }
    EXPECT_EQ(countOf(chart, "<tbody") - countOf(chart, "data-on-demand"), 3u) << "median, lowest, highest";
  }
  const std::string rays = between(html, "<b>Set size over rays</b>", "</figure>");
  EXPECT_NE(rays.find(">median</th></tr>\n<tr><td>1000</td><td>2550</td>"), std::string::npos) << rays;
  EXPECT_NE(rays.find(">lowest</th></tr>\n<tr><td>1000</td><td>100</td>"), std::string::npos) << rays;
  EXPECT_NE(rays.find(">highest</th></tr>\n<tr><td>1000</td><td>5000</td>"), std::string::npos) << rays;
}

TEST(BakePage, PicturesComeBeforeTheStageCharts) {
  const std::string html = pageOfCells(50);
  const size_t growth = html.find(">How the sets grew</h2>"), pictures = html.find(">Pictures</h2>"),
               stages = html.find(">Stage by stage</h2>");
  ASSERT_NE(stages, std::string::npos);
  EXPECT_LT(growth, pictures);
  EXPECT_LT(pictures, stages);
}

TEST(BakePage, SaysOnlyWhatPicturesShow) {
  BakeReport report = hostileReport();
  report.scene.surfaces = {};
  report.doors.clear();
  report.see_through.clear();
  BakePage page;
  page.curves.resize(report.cells.size());
  page.pictures.push_back({});
  const std::string plain = bakePage(report, page).html();
  for (const char* word : {"Through holes", "Glass tints", "drawn as glass"}) {
    EXPECT_EQ(plain.find(word), std::string::npos) << word;
  }
  report.scene.surfaces.masked = 1;
  report.doors.push_back({"door", 0, 1});
  const std::string other = bakePage(report, page).html();
  for (const char* sentence :
       {"Through holes one sees what is behind.", "Glass tints what is behind it, bluish.",
        "Doors that are open are drawn as glass."}) {
    EXPECT_NE(other.find(sentence), std::string::npos) << sentence;
  }
}

TEST(BakePage, CountsOneCellAsOne) {
  BakeReport report = hostileReport();
  report.cells.resize(1);
  report.planned_cells = 1;
  BakePage page;
  page.curves.resize(1);
  const std::string html = bakePage(report, page).html();
  EXPECT_NE(html.find("from 1 of 1 view cell,"), std::string::npos);
  EXPECT_NE(html.find("1 of 1 cell was baked by an earlier run"), std::string::npos);
}

TEST(BakePage, WithoutCurvesItStillHasItsTable) {
  BakePage page;
  page.curves.resize(2);
  const std::string html = bakePage(hostileReport(), page).html();
  EXPECT_EQ(html.find("<canvas"), std::string::npos);
  EXPECT_NE(html.find("ray limit"), std::string::npos);
}

/// The page, without curves.
std::string pageOf(const BakeReport& report) {
  BakePage page;
  page.curves.resize(report.cells.size());
  return bakePage(report, page).html();
}

TEST(BakePage, HasColumnsForWhatSomeCellsHave) {
  const auto shows = [](const BakeReport& report, const char* column) {
    return pageOf(report).find(std::string("<th scope=\"col\">") + column + "</th>") != std::string::npos;
  };
  BakeReport report = hostileReport();
  for (CellSummary& cell : report.cells) {
    cell.stats.bound_tests = 0;
    cell.stats.contained_triangles = 0;
  }
  EXPECT_FALSE(shows(report, "error at most"));
  EXPECT_FALSE(shows(report, "contained"));
  EXPECT_TRUE(shows(report, "warnings")) << "the second set is empty";
  report.cells[1].pvs_size = 3;
  EXPECT_FALSE(shows(report, "warnings"));
  EXPECT_EQ(pageOf(report).find("may not be meant so"), std::string::npos);
  report.cells[0].stats.bound_tests = 2;
  report.cells[0].stats.error_bound = 0.00125;
  report.cells[1].stats.contained_triangles = 7654;
  EXPECT_TRUE(shows(report, "error at most"));
  EXPECT_TRUE(shows(report, "contained"));
  EXPECT_NE(pageOf(report).find("<td>0.00125</td><td>0</td></tr>"), std::string::npos);
  EXPECT_NE(pageOf(report).find("<td>not tested</td><td>7654</td></tr>"), std::string::npos);
  report.warnings = {{{CellVerdict::kInSolid, "lies in a wall"}, {CellVerdict::kOutside, "far"}}};
  EXPECT_TRUE(shows(report, "warnings"));
  EXPECT_NE(pageOf(report).find("<td>0</td><td>in solid, outside</td></tr>"), std::string::npos);
  EXPECT_NE(pageOf(report).find("<td>7654</td><td></td></tr>"), std::string::npos);
  EXPECT_NE(pageOf(report).find("lies in a wall"), std::string::npos) << "below the table";
}

TEST(BakePage, ListsTheParametersOfTheMethod) {
  BakePage page;
  page.curves.resize(2);
  BakeReport report = hostileReport();
  const auto has = [&](Method method, const char* name) {
    report.params.method = method;
    return bakePage(report, page).html().find(std::string("<dt>") + name + "</dt>") != std::string::npos;
  };
  EXPECT_TRUE(has(Method::kGvspp, "border samples an edge"));
  EXPECT_FALSE(has(Method::kGvs, "border samples an edge"));
  EXPECT_TRUE(has(Method::kGvs, "discontinuity, share of the distance"));
  EXPECT_FALSE(has(Method::kRandom, "discontinuity, share of the distance"));
  EXPECT_TRUE(has(Method::kRaster, "pixels a side"));
  EXPECT_FALSE(has(Method::kRaster, "rays of a batch"));
  EXPECT_TRUE(has(Method::kRaster, "samples an iteration"));
  EXPECT_FALSE(has(Method::kRaster, "random rays an iteration"));
}

TEST(BakePage, NoNameBreaksIt) {
  BakePage page;
  page.curves = {exampleCurve(), exampleCurve()};
  page.command = kHostileName;
  const std::string html = bakePage(hostileReport(), page).html();
  EXPECT_EQ(html.find(kHostileName), std::string::npos);
  const std::string csv = curvesCsv(hostileReport(), page.curves);
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "cell,iteration,seconds,random_rays,border_rays,reverse_rays,random_new,border_new,reverse_new,"
            "triangles");
  EXPECT_NE(csv.find("\na,2,1,2000,600,0,105,54,0,159\n"), std::string::npos) << csv;
}

/// A cell of an earlier run has no curve, but its end is known.
TEST(CurvesCsv, HasALineForACellOfAnEarlierRun) {
  BakeReport report = hostileReport();
  report.cells[1].cell.name = std::string("b");
  const std::string csv = curvesCsv(report, {{}, exampleCurve()});
  const std::string lines = csv.substr(csv.find('\n') + 1);
  EXPECT_TRUE(lines.starts_with("a,4,0.875,1000,2000,30,7,3,1,11\nb,1,0.25,1000,0,0,100,0,0,100\n")) << csv;
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 1 + 5);
}

}  // namespace
}  // namespace sightline
