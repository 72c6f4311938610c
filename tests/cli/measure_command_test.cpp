// sightline measure, as a user runs it.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/pvs/pvs_file.h"
#include "tests/cli/run_program.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::runProgram;

ProgramRun expectRun(const std::string& arguments, int exit_code, const std::vector<std::string>& said) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.output;
  for (const std::string& text : said) {
    EXPECT_NE(run.output.find(text), std::string::npos) << "expected: " << text << "\n" << run.output;
  }
  return run;
}

/// A small city, baked.
class MeasureCommandTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    expectRun("scene city -o " + path("city.glb") + " --triangles 20000", 0, {});
    expectRun("cells " + path("city.glb") + " -o " + path("cells.json") +
                  " --path -43.1,1.5,-75 -43.1,1.5,75 --width 2.5 --height 2 --length 75",
              0, {});
    expectRun("bake " + path("city.glb") + " --cells " + path("cells.json") + " -o " + path("city.pvs") +
                  " --device cpu --n-rand 50000 --n-abs-edge 5 --n-rs-edge 5 --n-rs-area 5 --threshold 50"
                  " --validation-rays 0",
              0, {});
    // The same but for a tenth of the triangles.
    PvsFile poor = loadPvs(path("city.pvs"));
    for (CellPvs& cell : poor.cells) {
      std::vector<uint32_t> kept;
      for (size_t i = 0; i < cell.triangles.size(); ++i) {
        if (i % 10 != 3) kept.push_back(cell.triangles[i]);
      }
      cell.triangles = kept;
    }
    savePvs(poor, path("poor.pvs"));
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string path(const std::string& name) { return (*folder_ / name).string(); }
  static std::string input() { return path("city.glb") + " " + path("city.pvs"); }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(MeasureCommandTest, MeasuresSeveralSetsAtOnce) {
  const std::string command = "measure " + input() + " " + path("poor.pvs") +
                              " --device cpu --views 40 --resolution 60 --report " + path("r.json") +
                              " --csv " + path("r.csv") + " --html " + path("r.html") + " --pictures " +
                              path("pictures");
  expectRun(command, 0, {"40 views of 60 x 60 pixels", "all cells", "poor.pvs", "avg error", "rays in"});
  const auto report = nlohmann::json::parse(std::ifstream(path("r.json")));
  EXPECT_EQ(report["views"], 40);
  EXPECT_EQ(report["resolution"], 60);
  EXPECT_EQ(report["complete"], true);
  ASSERT_EQ(report["sets"].size(), 2u);
  const auto &good = report["sets"][0], &poor = report["sets"][1];
  EXPECT_LT(good["scene"]["wrong_share"], 0.001);
  EXPECT_GT(poor["scene"]["wrong_share"], 0.01);
  EXPECT_LT(poor["scene"]["wrong_share"], 0.5);
  for (const auto& cell : poor["cells"]) {
    EXPECT_GT(cell["average_wrong"], 10);
    EXPECT_GE(cell["max_wrong"], cell["largest_region"]);
    EXPECT_EQ(cell["worst_view"], cell["worst_views"][0]);
    ASSERT_EQ(cell["pictures"].size(), 3u);
    for (const std::string name : cell["pictures"]) {
      EXPECT_GT(std::filesystem::file_size(path("pictures") + "/" + name), 100u) << name;
    }
  }
  std::ifstream page(path("r.html"));
  const std::string html((std::istreambuf_iterator<char>(page)), {});
  size_t pictures = 0;
  for (size_t at = 0; (at = html.find("src=\"data:image/png;base64,", at)) != std::string::npos; ++at)
    ++pictures;
  size_t drawn = 0;
  for (const auto& set : report["sets"]) {
    for (const auto& cell : set["cells"]) drawn += cell["pictures"].size();
  }
  EXPECT_EQ(pictures, drawn);
  EXPECT_NE(html.find("poor.pvs</t"), std::string::npos);
  EXPECT_NE(html.find("<td>" + poor["cells"][0]["max_wrong"].dump() + "</td>"), std::string::npos);

  std::ifstream csv(path("r.csv"));
  std::string line;
  size_t lines = 0;
  for (; std::getline(csv, line); ++lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 11);
  EXPECT_EQ(lines, 1 + 2 * good["cells"].size());

  // One of them alone, one cell alone: the same numbers.
  expectRun("measure " + path("city.glb") + " " + path("poor.pvs") +
                " --device cpu --views 40 --resolution 60 --cell 1 --report " + path("one.json"),
            0, {});
  const auto one = nlohmann::json::parse(std::ifstream(path("one.json")));
  ASSERT_EQ(one["sets"][0]["cells"].size(), 1u);
  auto expected = poor["cells"][1];
  expected["pictures"] = nlohmann::json::array();
  EXPECT_EQ(one["sets"][0]["cells"][0], expected);
}

/// The folder holds the pictures of the last measurement of each cell, and what else lay in it.
TEST_F(MeasureCommandTest, RemovesItsOwnOldPictures) {
  const auto names = [] {
    std::set<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(path("worst"))) {
      all.insert(entry.path().filename().string());
    }
    return all;
  };
  const auto drawn = [](const std::string& report) {
    std::set<std::string> all;
    const auto json = nlohmann::json::parse(std::ifstream(path(report)));
    for (const auto& set : json["sets"]) {
      for (const auto& cell : set["cells"]) all.insert(cell["pictures"].begin(), cell["pictures"].end());
    }
    return all;
  };
  const auto with = [](std::set<std::string> a, const std::set<std::string>& b) {
    a.insert(b.begin(), b.end());
    return a;
  };
  std::filesystem::create_directory(path("worst"));
  const std::set<std::string> mine = {"000-path-1-outside.png", "000-path-1-view-1.png.txt", "view-1.png",
                                      "000-path-10-view-1.png", "000-path-1-view-x.png"};
  for (const std::string& name : mine) std::ofstream(path("worst") + "/" + name) << name;
  const std::string command = "measure " + path("city.glb") + " " + path("poor.pvs") +
                              " --device cpu --resolution 30 --pictures " + path("worst") + " --report ";
  expectRun(command + path("1.json") + " --views 20", 0, {});
  EXPECT_EQ(names(), with(mine, drawn("1.json")));

  // Other views, two files instead of one, one of the cells: the other keeps its pictures.
  expectRun(command + path("2.json") + " " + path("poor.pvs") + " --views 21 --seed 2 --cell 0", 0,
            {"worst: 3 pictures of an earlier run removed"});
  std::set<std::string> expected = with(mine, drawn("2.json"));
  EXPECT_EQ(drawn("2.json").size(), 6u);
  for (const std::string& name : drawn("1.json")) {
    if (name.starts_with("001-")) expected.insert(name);
  }
  EXPECT_EQ(names(), expected);

  expectRun(command + path("3.json") + " --views 22", 0, {"worst: 9 pictures of an earlier run removed"});
  EXPECT_EQ(names(), with(mine, drawn("3.json")));
}

TEST_F(MeasureCommandTest, ExitsWith3PastALimit) {
  const std::string start =
      "measure " + path("city.glb") + " " + path("poor.pvs") + " --device cpu --views 10 --resolution 40 ";
  expectRun(start + "--max-average 1600 --max-wrong 1600", 0, {});
  expectRun(start + "--max-average 1", 3, {"past the limit: ", "wrong pixels a view"});
  expectRun(start + "--max-wrong 1", 3, {"past the limit: ", "in view"});
}

/// A bake that stops by its target says so in every place, and keeps its promise.
TEST_F(MeasureCommandTest, AgreesWithTheBoundOfATargetedBake) {
  const std::string bake =
      "bake " + path("city.glb") + " --cells " + path("cells.json") + " -o " + path("target.pvs") +
      " --device cpu --method random --n-rand 20000 --validation-rays 0 --report " + path("target.json");
  expectRun(bake + " --target-error 1", 2, {"--target-error"});
  expectRun(bake + " --target-error 0.002", 0, {"error < 0.00", "(95 %)", "target error"});
  expectRun("info " + path("target.pvs"), 0, {"target_error 0.002", "error < 0.00"});
  const auto report = nlohmann::json::parse(std::ifstream(path("target.json")));
  EXPECT_EQ(report["parameters"]["target_error"], 0.002);
  for (const auto& cell : report["cells"]) {
    EXPECT_EQ(cell["stop_reason"], "target error");
    EXPECT_LT(cell["error_bound_95"], 0.002);
    EXPECT_GT(cell["error_bound_rays"], 5000);
  }
  expectRun("measure " + path("city.glb") + " " + path("target.pvs") +
                " --device cpu --views 200 --resolution 100 --max-average " +
                std::to_string(0.002 * 100 * 100),
            0, {"target.pvs"});
}

/// Ctrl-C: what is measured is said and written, the rest is not waited for.
TEST_F(MeasureCommandTest, EndsInOrderWhenStopped) {
  test::Running measure("measure " + input() + " --device cpu --views 1000000 --resolution 1000 --report " +
                            path("stopped.json"),
                        path("log"));
  const auto log = [] {
    std::ifstream in(path("log"));
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  // The first line of progress comes after a second.
  for (int i = 0; i < 600 && log().find("Mrays/s") == std::string::npos; ++i) ::usleep(50'000);
  measure.send(SIGINT);
  EXPECT_EQ(measure.wait(), 130) << log();
  EXPECT_NE(log().find("path-1 1/2  views "), std::string::npos) << log();
  EXPECT_NE(log().find(" left "), std::string::npos) << log();
  EXPECT_NE(log().find("stopped: 0 of 2 cells are measured"), std::string::npos) << log();
  const auto report = nlohmann::json::parse(std::ifstream(path("stopped.json")));
  EXPECT_EQ(report["complete"], false);
  EXPECT_TRUE(report["sets"][0]["cells"].empty());
}

TEST_F(MeasureCommandTest, SaysTheDefaultsOfAProcessor) {
  expectRun("measure " + input() + " --device cpu --cell 0", 0,
            {"200 views of 250 x 250 pixels a cell (the defaults of a processor)"});
  expectRun("measure --help", 0,
            {"(default: 2000; where a\n", "processor traces, 200)", "(default: 1000;\n",
             "where a processor traces, 250)"});
}

TEST_F(MeasureCommandTest, SaysWhatIsWrong) {
  expectRun("measure " + path("city.glb"), 2, {"pvs"});
  expectRun("measure " + input() + " --views 0", 2, {"--views"});
  expectRun("measure " + input() + " --resolution 4097", 2, {"--resolution"});
  expectRun("measure " + input() + " --fov 180", 2, {"--fov"});
  expectRun("measure " + input() + " --device gpu9", 2, {"gpu9"});
  expectRun("measure " + input() + " --cell nowhere", 2, {"nowhere"});
  expectRun("measure " + input() + " --report " + path("city.pvs"), 2, {"city.pvs"});
  PvsFile other = loadPvs(path("city.pvs"));
  other.planned[1].center.x += 1;
  other.cells[1].cell.center.x += 1;
  savePvs(other, path("other.pvs"));
  expectRun("measure " + input() + " " + path("other.pvs"), 1,
            {"other.pvs: holds other cells than", "shape"});
  other.cells.pop_back();
  savePvs(other, path("fewer.pvs"));
  expectRun("measure " + input() + " " + path("fewer.pvs"), 1, {"fewer.pvs: holds other cells than", "here"});
  other.scene_hash ^= 1;
  savePvs(other, path("foreign.pvs"));
  expectRun("measure " + input() + " " + path("foreign.pvs"), 1, {"foreign.pvs: was baked of another scene"});
}

}  // namespace
}  // namespace sightline
