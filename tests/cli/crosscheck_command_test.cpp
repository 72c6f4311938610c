// crosscheck and verify as a user runs them.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/formats/load_scene.h"
#include "tests/cli/run_program.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

using test::expectRun;
using test::ProgramRun;
using test::runProgram;

/// A small city with a baked cell.
class City {
 public:
  City() {
    runProgram("scene city -o " + (folder_ / "city.glb").string() + " --triangles 3000 --cells " +
               (folder_ / "all.json").string());
    const auto cells = nlohmann::json::parse(std::ifstream(folder_ / "all.json"));
    std::ofstream(folder_ / "cells.json") << nlohmann::json{{"cells", {cells["cells"][0]}}};
  }
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }
  std::string input() const { return *this / "city.glb" + " --cells " + *this / "cells.json"; }

 private:
  TemporaryFolder folder_;
};

TEST(CrosscheckCommand, ReportsAndKeepsToLimits) {
  const City city;
  const std::string start = "crosscheck " + city.input() + " --devices cpu,opencl --rays 2000";
  expectRun(start + " --max-wrong 0 --max-missed 0 --max-differences 0 --report " + city / "r.json", 0,
            {"vertex", "far-tiny", "right"});
  const auto report = nlohmann::json::parse(std::ifstream(city / "r.json"));
  ASSERT_EQ(report["kinds"].size(), 10u);
  EXPECT_EQ(report["kinds"][3]["kind"], "vertex");
  EXPECT_EQ(report["kinds"][3]["rays"], 2000);
  EXPECT_EQ(report["kinds"][3]["devices"][1]["differences"]["same"], 2000);
  ASSERT_EQ(report["worst"].size(), 20u);
  EXPECT_EQ(report["worst"][0]["origin"].size(), 3u);
  EXPECT_EQ(report["worst"][0]["answers"].size(), 2u);
  expectRun(start + " --kinds vertex,edge --check-every 1 --max-rounded 0", 3, {"past the limit", "rounded"});
  expectRun(start + " --kinds random --move 1e6 --scale 0.5 --max-wrong 0", 0, {"random"});
}

TEST(CrosscheckCommand, SaysWhatIsWrong) {
  const City city;
  expectRun("crosscheck " + city.input() + " --devices cpu --kinds sideways", 2, {"sideways"});
  expectRun("crosscheck " + city.input() + " --devices gpu9", 2, {"gpu9"});
  expectRun("crosscheck " + city.input() + " --devices cpu --move 1e30 --scale 1e38", 2,
            {"put a vertex beyond"});
  expectRun("crosscheck " + city.input() + " --devices cpu --scale 1e-30", 2, {"smaller than"});
  expectRun("crosscheck " + city.input() + " --devices cpu --scale nan", 2, {"nan is not a number"});
  expectRun("crosscheck " + city.input() + " --devices cpu --rounding nan", 2, {"nan is not a number"});
  expectRun("crosscheck " + city.input() + " --devices cpu --max-missed -1", 2, {"-1 is not a whole number"});
  expectRun("crosscheck " + city.input(), 2, {"--devices"});
  expectRun("crosscheck " + city.input() + " --devices cpu,opencl,cpu", 2, {"--devices: cpu is named twice"});
  expectRun("crosscheck " + city.input() + " --devices opencl,opencl:0", 2, {"which is named already"});
  expectRun("crosscheck " + city.input() + " --devices cpu --pvs", 2, {"--pvs: compares the sets of two"});
  expectRun("crosscheck " + city.input() + " --devices cpu --kinds edge,edge", 2,
            {"--kinds: edge is named twice"});
}

TEST(VerifyCommand, ProvesABakeAndWritesBetterWitnesses) {
  const City city;
  const std::string bake = "bake " + city.input() + " --device cpu --n-rand 100000 --validation-rays 0 -o ";
  expectRun(bake + city / "plain.pvs", 0, {});
  expectRun("verify " + city / "city.glb" + " " + city / "plain.pvs", 1, {"--witnesses"});
  expectRun(bake + city / "w.pvs" + " --witnesses", 0, {});
  expectRun("verify " + city / "city.glb" + " " + city / "w.pvs" + " -o " + city / "better.pvs" +
                " --report " + city / "v.json" + " --min-proven 0.99",
            0, {"proven", "0 are disproved"});
  const auto report = nlohmann::json::parse(std::ifstream(city / "v.json"));
  EXPECT_GT(report["cells"][0]["proven"], 50);
  EXPECT_EQ(report["cells"][0]["disproved"], 0);
  const PvsFile before = loadPvs(city / "w.pvs"), after = loadPvs(city / "better.pvs");
  EXPECT_EQ(before.cells[0].triangles, after.cells[0].triangles);

  PvsFile spoilt = before;
  for (Witness& witness : spoilt.cells[0].witnesses) witness.direction *= -1.0f;
  savePvs(spoilt, city / "spoilt.pvs");
  expectRun("verify " + city / "city.glb" + " " + city / "spoilt.pvs", 3, {"past the limit", "is disproved"});
}

/// A flat cell whose set, made by hand, has a triangle behind its plane and one by a ray that looks
/// backwards.
TEST(VerifyCommand, CountsAndTakesOutWhatAFlatCellDoesNotSee) {
  const TemporaryFolder folder;
  const std::string scene_file = (folder / "corridor.obj").string(), bad = (folder / "bad.pvs").string();
  std::ofstream(scene_file) << "v -9 -9 9\nv 9 -9 9\nv 0 9 9\nv -9 -9 -9\nv 9 -9 -9\nv 0 9 -9\n"
                               "v -9 -2 -9\nv 9 -2 -9\nv 0 -2 20\nf 1 2 3\nf 4 5 6\nf 7 8 9\n";
  const Scene scene = loadScene(scene_file);
  PvsFile pvs;
  pvs.scene_hash = hashScene(scene);
  pvs.triangle_count = 3;
  pvs.scene_name = "corridor.obj";
  pvs.has_witnesses = true;
  pvs.planned = {{"flat", {0, 0, 0}, {2, 1, 0}, {0, 0, 0}}};
  const glm::vec3 origin(0.25f, 0.125f, 0);
  CellPvs& cell = pvs.cells.emplace_back();
  cell.cell = pvs.planned[0];
  cell.triangles = {0, 1, 2};
  cell.witnesses = {{origin, glm::vec3(0, 0, 9) - origin, kStageRandom},
                    {origin, glm::vec3(0, 0, -9) - origin, kStageBorder},
                    {origin, glm::vec3(0, -2, -1) - origin, kStageReverse}};
  savePvs(pvs, bad);
  const std::string verify = "verify " + scene_file + " ", better = (folder / "better.pvs").string();
  expectRun(verify + bad + " -o " + better + " --report " + (folder / "v.json").string(), 3,
            {"flat: disproved are 1: it lies behind the flat cell's plane; 1: its ray leaves the flat cell "
             "backwards",
             "2 disproved triangles are left out", "past the limit: 0.3333333 proven"});
  expectRun(verify + bad + " --max-disproved 2 --min-proven 0.3", 0, {"2 are disproved"});
  expectRun(verify + bad + " --max-disproved 2 --min-proven 0.4", 3, {"past the limit"});
  expectRun(verify + better + " --min-proven 1", 0, {"0 are disproved"});
  EXPECT_EQ(loadPvs(better).cells[0].triangles, std::vector<uint32_t>{0});
  const auto report = nlohmann::json::parse(std::ifstream(folder / "v.json"));
  EXPECT_EQ(report["cells"][0]["faults"]["behind"], 1);
  EXPECT_EQ(report["cells"][0]["faults"]["backwards"], 1);
}

}  // namespace
}  // namespace sightline
