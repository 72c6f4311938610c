#include "core/bake/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/bake/cell_table.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/export/export.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

using nlohmann::json;

BakeReport exampleReport() {
  BakeReport report;
  report.version = "1.2.3";
  report.scene = {"room.obj", 0xabcdef, 1000, 700, 3, 1, 2, 4, 6, 5, 7, 0, {}, {"far off"}};
  report.baked_on = "cpu";
  report.device = DeviceInfo{"cpu", "host", "built in", "8-wide", "", 5};
  report.tree = TreeSummary{0.5, 12.5, 9, 10, 20, 1100, 9000};
  report.set = "array";
  report.cells = summarize(examplePvs());
  report.cells[0].open_stats = report.cells[0].stats;
  report.cells[0].open_added = 3;
  report.doors = {{"door", 10, 2}};
  report.see_through = {{"pane", 20, 2}};
  for (const CellSummary& cell : report.cells) report.bounds.push_back(cell.pvs_size + 2);
  report.leaks = {Leaks{0.5f, 7, 300, {1, 2, 3}, 1000, 0.25}, {}};
  report.warnings = {{{CellVerdict::kMeetsTriangles, "meets 12 triangles", 12}}, {}, {}};
  report.planned_cells = 3;
  report.resumed_cells = 1;
  return report;
}

/// All keys at any depth.
void collectKeys(const json& value, std::set<std::string>& keys) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) keys.insert(key), collectKeys(inner, keys);
  } else if (value.is_array()) {
    for (const auto& inner : value) collectKeys(inner, keys);
  }
}

/// Adds the words in backquotes of the section that begins with this heading.
void collectWords(const std::string& heading, std::set<std::string>& words) {
  std::ifstream in(SL_SOURCE_DIR "/docs/report.md");
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("## ", 0) == 0) {
      inside = line == heading;
      continue;
    }
    std::istringstream text(inside ? line : "");
    std::string part;
    for (bool quoted = false; std::getline(text, part, '`'); quoted = !quoted) {
      if (quoted) words.insert(part);
    }
  }
}

TEST(Report, SaysWhatWasDone) {
  const json report = json::parse(reportJson(exampleReport()));
  EXPECT_EQ(report["sightline"], "1.2.3");
  EXPECT_EQ(report["complete"], false);
  EXPECT_EQ(report["device"]["driver"], "built in");
  EXPECT_EQ(report["scene"]["hash"], "0000000000abcdef");
  EXPECT_EQ(report["tree"]["bytes_per_triangle"], 9.0);
  ASSERT_EQ(report["cells"].size(), 2u);
  const json& cell = report["cells"][0];
  EXPECT_EQ(cell["name"], "a");
  EXPECT_EQ(cell["pvs_size"], 7);
  EXPECT_EQ(cell["pvs_share"], 0.007);
  EXPECT_EQ(cell["rays"], 3030);
  EXPECT_DOUBLE_EQ(cell["mrays_per_s"], 3030 / 0.875e6);
  EXPECT_EQ(cell["stages"]["border"]["new_triangles"], 3);
  EXPECT_EQ(cell["stop_reason"], "ray limit");
  EXPECT_EQ(cell["missing_share"], 0.002);
  EXPECT_EQ(cell["missing_upper_bound_95"], missingUpperBound(1, 500));
  EXPECT_EQ(cell["error_bound_95"], 0.0625);
  EXPECT_EQ(cell["error_bound_rays"], 1u << 20);
  EXPECT_EQ(cell["error_bound_tests"], 3);
  ASSERT_EQ(cell["warnings"].size(), 1u);
  EXPECT_EQ(cell["warnings"][0]["verdict"], "meets triangles");
  EXPECT_EQ(cell["warnings"][0]["text"], "meets 12 triangles");
  EXPECT_EQ(cell["warnings"][0]["met_triangles"], 12);
  ASSERT_EQ(report["cells"][1]["warnings"].size(), 1u) << "its set is empty";
  EXPECT_EQ(report["cells"][1]["warnings"][0]["verdict"], "sees nothing");
}

TEST(Report, SeeingAllThatHasAnAreaIsSeeingEverything) {
  BakeReport report = exampleReport();
  report.cells[0].pvs_size = uint32_t(report.scene.triangles - report.scene.degenerate);
  ASSERT_EQ(warningsOf(report, 0).size(), 2u);
  EXPECT_EQ(warningsOf(report, 0)[1].verdict, CellVerdict::kSeesEverything);
  report.cells[0].pvs_size--;
  EXPECT_EQ(warningsOf(report, 0).size(), 1u);
}

TEST(CellTable, NamesTheVerdicts) {
  const std::vector<CellSummary> cells = summarize(examplePvs());
  const std::vector<std::vector<CellWarning>> warnings = {
      {{CellVerdict::kMeetsTriangles, "", 12}, {CellVerdict::kInSolid, ""}}, {}};
  const std::string table = cellTable(cells, 1000, warnings);
  EXPECT_NE(table.find("  warning: meets triangles, in solid\n"), std::string::npos) << table;
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
  EXPECT_EQ(table.find("warning"), table.rfind("warning"));
  EXPECT_EQ(cellTable(cells, 1000).find("warning"), std::string::npos);
}

TEST(Report, TellsOfLeaks) {
  EXPECT_EQ(leaksText({}), "");
  EXPECT_EQ(
      leaksText({0.005f, 7, 300, {1, 2.5, -3}, 1000, 0.25}),
      "7 triangles of the set are seen only through gaps narrower than 0.005, triangle 300 through one at "
      "(1, 2.5, -3); --smallest-hole 0.005 closes them");
  const json text = json::parse(reportJson(exampleReport()));
  EXPECT_EQ(text["cells"][0]["leaks"]["triangles"], 7);
  EXPECT_EQ(text["cells"][0]["open"]["added"], 3);
  EXPECT_TRUE(text["cells"][1]["leaks"].is_null());
  EXPECT_FALSE(text["cells"][1].contains("open"));
  EXPECT_EQ(text["features"]["doors"][0]["name"], "door");
}

TEST(Report, WithoutADeviceItSaysNull) {
  BakeReport report = exampleReport();
  report.device.reset();
  report.tree.reset();
  report.set.clear();
  const json text = json::parse(reportJson(report));
  EXPECT_TRUE(text["device"].is_null());
  EXPECT_TRUE(text["tree"].is_null());
  EXPECT_TRUE(text["features"]["set"].is_null());
}

TEST(Report, EveryKeyIsDocumentedAndEveryDocumentedKeyIsThere) {
  std::set<std::string> keys;
  collectKeys(json::parse(reportJson(exampleReport())), keys);
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles.assign(1000, {0, 1, 2});
  scene.objects = {{"all", 0, 1000}};
  const PvsFile pvs = examplePvs();
  collectKeys(json::parse(cellJson(pvs, pvs.cells[0], &scene)), keys);
  std::set<std::string> documented;
  collectWords("## `sightline bake --report R.json`", documented);
  collectWords("## `sightline export --format json`", documented);
  // Words in backquotes that are no keys: commands and values.
  for (const char* word : {"--scene", "array", "hash", "converged", "ray limit", "time limit", "target error",
                           "meets triangles", "in solid", "outside", "too large", "too small", "sees nothing",
                           "sees everything", "--strict-cells", "--free-side back", "any"}) {
    EXPECT_EQ(documented.count(word), 1u) << word;
    if (std::string(word) != "hash") documented.erase(word);
  }
  EXPECT_EQ(keys, documented);
}

TEST(Report, SurvivesNamesThatAreNotUtf8) {
  BakeReport report = exampleReport();
  report.cells[0].cell.name = "caf\xe9";
  EXPECT_TRUE(json::accept(reportJson(report)));
}

TEST(Report, WarnsOfMaterialsInOneLineAndPassesOnWhatLoadingSaid) {
  SceneSummary scene;
  EXPECT_TRUE(sceneWarnings(scene).empty());
  scene.warnings = {"far away"};
  EXPECT_EQ(sceneWarnings(scene), (std::vector<std::string>{"far away"}));
  scene.alpha = 3;
  scene.glass = 2;
  scene.opaque_masks = 1;
  scene.single_sided = 4;
  EXPECT_EQ(
      sceneWarnings(scene),
      (std::vector<std::string>{
          "1 triangles with masks are traced as opaque; 4 single-sided triangles are traced as two-sided",
          "far away"}));
  scene.surfaces.front_only = 4;
  EXPECT_EQ(sceneWarnings(scene),
            (std::vector<std::string>{"1 triangles with masks are traced as opaque", "far away"}));
}

Scene threeObjects() {
  Scene scene;
  for (int i = 0; i < 10; ++i) scene.positions.push_back({i, i * i, -i});
  for (uint32_t i = 0; i < 8; ++i) scene.triangles.push_back({i, i + 1, i + 2});
  scene.objects = {{"a", 0, 3}, {"b", 3, 2}, {"c", 5, 3}};
  return scene;
}

TEST(Export, IdsAreOneALine) {
  EXPECT_EQ(idsText(exampleCell({}, {0, 17, 4294967290u}, false)), "0\n17\n4294967290\n");
  EXPECT_EQ(idsText(exampleCell({}, {}, false)), "");
}

TEST(Export, VisibleSceneKeepsCornersOrderAndObjectNames) {
  const Scene scene = threeObjects();
  const std::vector<uint32_t> ids = {1, 2, 6};
  const Scene visible = visibleScene(scene, exampleCell({}, ids, false));
  ASSERT_EQ(visible.triangles.size(), 3u);
  for (size_t i = 0; i < ids.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      EXPECT_EQ(visible.positions[visible.triangles[i][corner]],
                scene.positions[scene.triangles[ids[i]][corner]])
          << i << " " << corner;
    }
  }
  EXPECT_EQ(visible.positions.size(), 7u);
  ASSERT_EQ(visible.objects.size(), 2u);
  EXPECT_EQ(visible.objects[0].name, "a");
  EXPECT_EQ(visible.objects[0].triangle_count, 2u);
  EXPECT_EQ(visible.objects[1].name, "c");
  EXPECT_EQ(visible.objects[1].first_triangle, 2u);
  EXPECT_THROW(visibleScene(scene, exampleCell({}, {}, false)), Error);
}

TEST(Export, JsonCountsTheVisibleOfEachObject) {
  const Scene scene = threeObjects();
  PvsFile pvs = examplePvs();
  pvs.triangle_count = 8;
  const json cell = json::parse(cellJson(pvs, exampleCell({}, {1, 2, 6}, false), &scene));
  EXPECT_EQ(cell["ids"], (json{1, 2, 6}));
  ASSERT_EQ(cell["objects"].size(), 3u);
  EXPECT_EQ(cell["objects"][0]["visible"], 2);
  EXPECT_EQ(cell["objects"][1]["visible"], 0);
  EXPECT_EQ(cell["objects"][2]["visible"], 1);
  EXPECT_FALSE(json::parse(cellJson(pvs, exampleCell({}, {1}, false), nullptr)).contains("objects"));
}

}  // namespace
}  // namespace sightline
