// walk as a user runs it, on the processor: what it writes, and what it refuses.
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::expectRun;
using test::Folder;
using test::readText;

class WalkCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    expectRun("scene city --triangles 3000 -o " + at("c.glb") + " --walk " + at("w.json") + " --frames 60", 0,
              {});
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string walk(const std::string& more) const {
    return "walk " + at("c.glb") + " --path " + at("w.json") +
           " --device cpu --resolution 48x36 --repeats 1 " + more;
  }
  Folder folder_;
};

TEST_F(WalkCommandTest, WritesReportTablePageAndPictures) {
  expectRun(walk("--schedule fixed --max-false 0 --trace-every 20 --report " + at("r.json") + " --csv " +
                 at("r.csv") + " --html " + at("r.html") + " --pictures " + at("pics")),
            0, {"hiz, hiz-meshlets, boxes", "pvs, pvs+vfc", "opti-chc++", "traced"});
  const json report = json::parse(readText(at("r.json")));
  EXPECT_TRUE(report["complete"]);
  EXPECT_EQ(report["frames"], 60);
  EXPECT_EQ(report["methods"].size(), 7u);
  EXPECT_EQ(report["left_out"].size(), 6u);
  EXPECT_EQ(report["traced"].size(), 3u);
  for (const json& method : report["methods"]) {
    EXPECT_EQ(method["stretches"].size(), 3u);
    if (method["name"] != "late") {
      EXPECT_EQ(method["check"]["false_pixels"], 0) << method["name"];
    }
  }
  const std::string csv = readText(at("r.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 7 * 60);
  EXPECT_EQ(csv.rfind("method,frame,frame_ms,gpu_ms,", 0), 0u);
  const std::string page = readText(at("r.html"));
  for (const char* part : {"Frame time by method", "Processor time by part", "Queries a frame",
                           "Submits a frame", "Triangles a frame", "data-stacked", "What is wrong",
                           "The slowest frame of opti-chc++", "1 % low", "traced"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_TRUE(std::filesystem::exists(at("pics/drawn-opti-chc++-frame-15.png")));
  // The counts again, with another schedule the same pictures' names vanish.
  expectRun(walk("--methods vfc --check none --pictures " + at("pics")), 0, {"vfc"});
  EXPECT_FALSE(std::filesystem::exists(at("pics/drawn-opti-chc++-frame-15.png")));
}

TEST_F(WalkCommandTest, LosesNothingThatItHasFoundOrDrawn) {
  // A folder where a picture should go: the report is written all the same.
  std::filesystem::create_directories(at("p/drawn-vfc-frame-15.png"));
  const std::string outputs =
      " --report " + at("r.json") + " --csv " + at("r.csv") + " --pictures " + at("p");
  const std::string vfc = walk("--methods vfc --check none" + outputs);
  expectRun(vfc, 1, {"drawn-vfc-frame-15.png"});
  EXPECT_TRUE(json::parse(readText(at("r.json")))["complete"]);
  EXPECT_TRUE(std::filesystem::exists(at("r.csv")));
  // A run that cannot begin leaves the pictures of the last one.
  std::filesystem::remove_all(at("p"));
  expectRun(vfc, 0, {"vfc"});
  ASSERT_TRUE(std::filesystem::exists(at("p/drawn-vfc-frame-15.png")));
  expectRun(walk("--methods hiz --pictures " + at("p")), 1, {"hiz cannot run"});
  EXPECT_TRUE(std::filesystem::exists(at("p/drawn-vfc-frame-15.png")));
}

TEST_F(WalkCommandTest, ReplaysSetsAndViewsOfACell) {
  expectRun("cells " + at("c.glb") + " -o " + at("cells.json") + " --walk " + at("w.json") + " --length 60",
            0, {});
  expectRun("bake " + at("c.glb") + " --cells " + at("cells.json") + " -o " + at("c.pvs") +
                " --device cpu --n-rand 20000 --validation-rays 0",
            0, {});
  const std::string sets = "--pvs " + at("c.pvs") + " ";
  expectRun(walk(sets + "--methods none,pvs,pvs+vfc --outside error --report " + at("r.json")), 0,
            {"pvs+vfc"});
  const json report = json::parse(readText(at("r.json")));
  for (const json& method : report["methods"]) EXPECT_EQ(method["frames_outside"], 0);
  EXPECT_LT(report["methods"][1]["triangles"], report["methods"][0]["triangles"]);
  expectRun("walk " + at("c.glb") +
                " --path views:walk-1 --views 10 --device cpu --resolution 32x32 --repeats 1 " + sets +
                "--methods vfc,pvs --report " + at("v.json"),
            0, {});
  EXPECT_EQ(json::parse(readText(at("v.json")))["cuts"].size(), 9u);
  // Cells of one run, each drawn by its own set, though they overlap.
  json overlapping = json::parse(readText(at("cells.json")));
  json& cells = overlapping["cells"];
  cells.erase(cells.begin() + 1, cells.end());
  json large = cells[0];
  large["name"] = "large";
  large["size"][2] = 2 * double(large["size"][2]);
  cells.push_back(large);
  folder_.write("two.json", overlapping.dump());
  expectRun("bake " + at("c.glb") + " --cells " + at("two.json") + " -o " + at("two.pvs") +
                " --device cpu --n-rand 20000 --validation-rays 0",
            0, {});
  const std::string two = "walk " + at("c.glb") +
                          " --device cpu --resolution 32x32 --repeats 1 --views 5 --pvs " + at("two.pvs") +
                          " --methods none,pvs ";
  expectRun(two + "--path views:large,walk-1 --report " + at("two-report.json") + " --html " + at("two.html"),
            0, {});
  const json by_cell = json::parse(readText(at("two-report.json")))["cells"];
  ASSERT_EQ(by_cell.size(), 2u);
  for (int i : {0, 1}) {
    const json& cell = by_cell[size_t(i)];
    EXPECT_EQ(cell["name"], i == 0 ? "large" : "walk-1");
    EXPECT_EQ(cell["first_frame"], 5 * i);
    EXPECT_EQ(cell["end_frame"], 5 * i + 5);
    EXPECT_EQ(cell["methods"]["pvs"]["triangles"], cell["triangles"]) << "its own set";
    EXPECT_EQ(cell["methods"]["none"]["false_pixels"], 0);
  }
  EXPECT_GT(by_cell[0]["triangles"], by_cell[1]["triangles"]);
  EXPECT_NE(readText(at("two.html")).find("What the set of each cell is worth"), std::string::npos);
  expectRun(two + "--path views:large,large", 2, {"large is named twice"});
  expectRun(two + "--path views:", 2, {"two.pvs"});
  // Another scene's set; a camera outside.
  expectRun("scene city --triangles 2000 -o " + at("d.glb") + " --walk " + at("d.json") + " --frames 60", 0,
            {});
  expectRun("walk " + at("d.glb") + " --path " + at("d.json") + " --device cpu " + sets, 1,
            {"c.pvs: was baked of another scene"});
  const auto far = folder_.write("far.json", R"({"keys":[{"frame":0,"eye":[0,900,0],"look":[0,0,1]},
                                                        {"frame":3,"eye":[0,900,1],"look":[0,0,1]}]})");
  const std::string outside = "walk " + at("c.glb") + " --path " + far.string() +
                              " --device cpu --resolution 32x24 --repeats 1 --methods pvs " + sets;
  expectRun(outside + "--outside error --csv " + at("o.csv"), 1, {"frame 0"});
  EXPECT_EQ(readText(at("o.csv")).rfind("method,frame,", 0), 0u);
  expectRun(outside + "--outside all --max-false 0 --report " + at("o.json"), 0, {});
  EXPECT_EQ(json::parse(readText(at("o.json")))["methods"][0]["frames_outside"], 4);
}

TEST_F(WalkCommandTest, SaysWhatIsWrong) {
  expectRun(walk("--methods pvs"), 2, {"--methods: pvs takes the sets of a bake: give it --pvs OUT.pvs"});
  expectRun(walk("--methods vcf"), 2, {"no culling method is called 'vcf'", "did you mean vfc?"});
  expectRun(walk("--methods vfc,vfc"), 2, {"vfc is named twice"});
  expectRun(walk("--methods hiz"), 1,
            {"hiz cannot run on drawing on the processor: a GPU must choose what is drawn"});
  expectRun("walk " + at("c.glb") + " --path " + at("w.json") + " --device cpu --resolution 0x3", 2,
            {"--resolution: 0x3 is not WIDTHxHEIGHT, each 1 to 16384"});
  expectRun(walk("--check none --max-false 0"), 2, {"--max-false: takes --check all"});
  expectRun("walk " + at("c.glb") + " --path views:0 --device cpu", 2,
            {"views:CELL takes the cell of a bake"});
  expectRun("walk " + at("c.glb") + " --path " + at("w.json") + " --device fast", 2,
            {"no device \"fast\" draws"});
  expectRun("walk nothing.glb --path w.json --device fast", 2, {"no device \"fast\" draws"});
  const auto bad = folder_.write("bad.json", R"({"keys":[]})");
  expectRun("walk " + at("c.glb") + " --path " + bad.string() + " --device cpu", 2,
            {"bad.json: keys: is empty"});
  const auto one = folder_.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expectRun("walk " + one.string() + " --path " + at("w.json") + " --device cpu --resolution 8x8 --repeats 1",
            0, {"the scene is one object", "--split"});
}

TEST_F(WalkCommandTest, NamesOptionsThatNothingTakes) {
  expectRun(
      walk("--methods vfc --no-c-queue --batch 7 --outside nearest --schedule fixed --trace-every 0 "
           "--trace-device "
           "cpu --views 3 --doors open"),
      0,
      {"note: --no-c-queue does nothing here: it is of opti-chc++",
       "note: --batch does nothing here: it is of chc++, opti-chc++",
       "note: --outside does nothing here: it is of pvs, pvs+vfc, pvs+hiz",
       "note: --schedule does nothing here", "note: --trace-device does nothing here",
       "note: --views does nothing here: it is of --path views:CELL", "note: --doors does nothing here"});
  const std::string taken =
      test::runProgram(walk("--methods chc++ --batch 7 --schedule fixed --no-tight --trace-every 30")).output;
  EXPECT_EQ(taken.find("does nothing"), std::string::npos) << taken;
  expectRun(walk("--methods vfc --check none --trace-every 5"), 0, {"note: --trace-every does nothing here"});
  expectRun("scene city --triangles 2000 -o " + at("e.glb") + " --frames 60", 2, {"--frames", "--walk"});
  expectRun("scene --help", 0, {"Of the walk, 60 to 1000000"});
}

TEST_F(WalkCommandTest, EndsWellOnCtrlC) {
  test::Running program("walk " + at("c.glb") + " --path " + at("w.json") +
                            " --device cpu --resolution 640x480 --repeats 50 --methods vfc,chc --report " +
                            at("r.json") + " --csv " + at("r.csv"),
                        at("out.txt"));
  for (int i = 0; i < 200 && readText(at("out.txt")).find("frame ") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  program.send(SIGINT);
  EXPECT_EQ(program.wait(), 130) << readText(at("out.txt"));
  const json report = json::parse(readText(at("r.json")));
  EXPECT_FALSE(report["complete"]);
  EXPECT_EQ(report["problem"], "");
  EXPECT_NE(readText(at("r.csv")).find("\nvfc,0,"), std::string::npos);
  EXPECT_NE(readText(at("out.txt")).find("stopped: "), std::string::npos);
}

}  // namespace
}  // namespace sightline
