#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/formats/load_scene.h"
#include "core/formats/save_scene.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"
#include "tests/support/boxes.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using test::expectRun;
using test::readText;
using test::runProgram;

constexpr const char* kQuick = " --device cpu --n-rand 100k --validation-rays 50k --check-rays 50k --tight";

/// A box in a box, as two objects, and a cell between them.
class BoxInBox {
 public:
  BoxInBox() {
    testing_support::SceneOfBoxes boxes;
    boxes.addBox({0, 0, 0}, {9, 9, 9});
    boxes.addBox({3, 3, 3}, {6, 6, 6});
    Scene scene = boxes.finish();
    scene.objects = {{"shell", 0, 12}, {"core", 12, 12}};
    for (const char* name : {"a.glb", "a.obj"}) saveScene(scene, folder_ / name);
    std::ofstream(folder_ / "cells.json")
        << R"({"cells":[{"name":"gap","center":[1,4.5,4.5],"size":[0.5,0.5,0.5]},)"
        << R"({"name":"top","center":[4.5,8,4.5],"size":[0.5,0.5,0.5]}]})";
  }
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
};

TEST(StripCommand, DropsWhatIsNotSeenFromOutside) {
  const BoxInBox files;
  for (const char* kind : {".glb", ".obj"}) {
    const std::string out = files / (std::string("b") + kind);
    const std::string command = "strip " + (files / (std::string("a") + kind)) + " -o " + out + kQuick;
    expectRun(command, 0,
              {"outside-x: sees 10 triangles; 0 of 50.0k fresh rays meet others first",
               ": 12 of 24 triangles (50.0 %)", "12 triangles went; of 2 objects, 1 with all that they have",
               "check: 0 of 300000 fresh rays meet first what went: at most 12 in a million"});
    const Scene left = loadScene(out);
    EXPECT_EQ(left.triangleCount(), 12u);
    EXPECT_EQ(left.objects[0].name, "shell");
    expectRun(command, 1, {"is there already; name another file, or --overwrite it"});
    // Of the bake of so few rays hardly anything is left but what --rays find.
    expectRun("strip " + (files / (std::string("a") + kind)) + " -o " + out +
                  " --overwrite --device cpu --n-rand 1 --max-rays 1 --validation-rays 0 --aimed 0 --tight "
                  "--rays 50k",
              0, {"rays: 50.0k from each cell meet ", ": 12 of 24 triangles (50.0 %)"});
    expectRun(command + " --overwrite --keep-objects", 0,
              {"13 of 24 triangles", "0 with all that they have"});
  }
}

TEST(StripCommand, TakesCellsOrABakeOfThem) {
  const BoxInBox files;
  const std::string scene = files / "a.glb", cells = files / "cells.json", pvs = files / "a.pvs";
  expectRun("strip " + scene + " -o " + (files / "b.glb") + " --from " + cells + kQuick, 0, {"gap: sees "});
  expectRun("bake " + scene + " --cells " + cells + " -o " + pvs +
                " --device cpu --n-rand 100k --validation-rays 50k",
            0, {});
  expectRun("strip " + scene + " -o " + (files / "c.glb") + " --from " + pvs + kQuick, 0, {"gap: sees "});
  EXPECT_EQ(readText(files / "b.glb"), readText(files / "c.glb"));
  // From the gaps on two sides all of the shell shows, and two sides of the core.
  const Scene left = loadScene(files / "b.glb");
  EXPECT_EQ(left.objects[0].triangle_count, 12u);
  EXPECT_EQ(left.objects[1].triangle_count, 4u);
  // Each of the core's other sides borders on one of these, by one of its two triangles or by both.
  const std::string wide = std::string(kQuick).substr(0, std::string(kQuick).find(" --tight"));
  expectRun("strip " + scene + " -o " + (files / "e.glb") + " --from " + pvs + wide, 0,
            {" of 500 rays of each cell at each triangle that would go meet ", "; the last none that goes",
             " stay because they share an edge with one that is seen"});
  const uint32_t margin = loadScene(files / "e.glb").objects[1].triangle_count;
  EXPECT_GT(margin, 7u);
  EXPECT_LT(margin, 12u);
  expectRun("strip " + (files / "b.glb") + " -o " + (files / "d.glb") + " --from " + pvs + kQuick, 1,
            {"a.pvs"});
}

TEST(StripCommand, KeepsWhatOpenDoorsShow) {
  const BoxInBox files;
  const std::string scene = files / "a.glb", pvs = files / "a.pvs";
  expectRun("bake " + scene + " --cells " + (files / "cells.json") + " -o " + pvs +
                " --doors core --device cpu --n-rand 100k --validation-rays 0",
            0, {});
  expectRun("strip " + scene + " -o " + (files / "b.glb") + " --from " + pvs + kQuick, 0,
            {": 24 of 24 triangles"});  // the core as a door shows its other sides
}

/// Rays of strip's own look at both states of the doors, and through what hides nothing.
TEST(StripCommand, OwnRaysSeeWhatOpenDoorsShow) {
  const BoxInBox files;
  const std::string scene = files / "a.glb", pvs = files / "a.pvs";
  // Sets of hardly anything: what the rays find decides.
  const std::string few =
      " --device cpu --n-rand 1 --max-rays 1 --validation-rays 0 --check-rays 20k --tight";
  const std::string bake = "bake " + scene + " --cells " + (files / "cells.json") + " -o " + pvs +
                           " --overwrite --device cpu --n-rand 1 --max-rays 1 --validation-rays 0";
  const std::string strip =
      "strip " + scene + " -o " + (files / "b.glb") + " --overwrite --from " + pvs + few;
  expectRun(bake + " --doors core", 0, {});
  expectRun(strip + " --aimed 0 --rays 50k", 0,
            {"gap: with the doors open ", "rays: 50.0k from each cell with the doors open meet ",
             ": 24 of 24 triangles", "check: with the doors open 0 of 40000 fresh rays"});
  expectRun(strip, 0, {": 24 of 24 triangles"});  // by aimed rays
  const test::ProgramRun lost = expectRun(strip + " --aimed 0", 0, {"check: with the doors open "});
  EXPECT_EQ(lost.output.find("check: with the doors open 0 of"), std::string::npos) << lost.output;
  expectRun(bake + " --see-through core", 0, {});
  const test::ProgramRun through =
      expectRun(strip + " --aimed 0 --rays 50k", 0, {": 24 of 24 triangles", "check: 0 of 40000 fresh rays"});
  EXPECT_EQ(through.output.find("doors"), std::string::npos) << through.output;
  expectRun(bake, 0, {});
  expectRun(strip + " --aimed 0 --rays 50k", 0, {": 16 of 24 triangles"});  // closed: two sides of the core
}

TEST(StripCommand, SaysWhatIsWrong) {
  const BoxInBox files;
  const std::string scene = files / "a.glb";
  expectRun("strip " + scene + " -o " + scene + " --overwrite" + kQuick, 2, {"a.glb"});
  const test::ProgramRun other = expectRun("strip " + scene + " -o " + (files / "b.obj") + kQuick, 2,
                                           {"must end with .glb, as the scene does"});
  EXPECT_EQ(other.output.find("triangles"), std::string::npos) << "refused before the work: " << other.output;
  expectRun("strip " + scene + " -o " + (files / "b.glb") + " --from no.json" + kQuick, 1,
            {"no.json: cannot open"});
  expectRun("strip " + scene + " -o -" + kQuick, 2, {"standard output"});
  const test::ProgramRun nowhere =
      expectRun("strip " + scene + " -o " + (files / "no/b.glb") + kQuick, 1, {"no/b.glb: cannot create"});
  EXPECT_EQ(nowhere.output.find("triangles"), std::string::npos)
      << "refused before the work: " << nowhere.output;
  std::ofstream(files / "torn.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n";
  const test::ProgramRun torn =
      expectRun("strip " + (files / "torn.obj") + " -o " + (files / "c.obj") + kQuick, 1,
                {"torn.obj:5: vertex index 4 is out of range 1..3; mend the file first"});
  EXPECT_EQ(torn.output.find("--repair"), std::string::npos) << torn.output;
  EXPECT_FALSE(std::filesystem::exists(files / "b.glb"));
}

TEST(ExportObjects, ASecondReaderFindsTheSame) {
  if (runProgram("help; python3 --version").exit_code != 0) GTEST_SKIP() << "no python3";
  const BoxInBox files;
  const std::string scene = files / "city.glb", pvs = files / "city.pvs", file = files / "city.json";
  expectRun("scene city -o " + scene + " --triangles 5000 --cells " + (files / "city-cells.json"), 0, {});
  expectRun("bake " + scene + " --cells " + (files / "city-cells.json") + " -o " + pvs +
                " --device cpu --n-rand 100k --validation-rays 0",
            0, {});
  const std::string command =
      "export " + pvs + " --format objects --scene " + scene + " --device cpu --rays 30k -o ";
  expectRun(command + file, 0, {"objects of 10 cells"});
  std::string sets;
  const auto document = nlohmann::json::parse(readText(file));
  for (const auto& cell : document["cells"]) {
    const std::string name = cell["name"], ids = files / (name + ".txt");
    expectRun("export " + pvs + " --cell " + name + " --format ids -o " + ids, 0, {});
    sets += " " + name + "=" + ids;
  }
  const test::ProgramRun reader =
      runProgram("help > /dev/null; python3 '" SL_SOURCE_DIR "/tests/cli/objects_reader.py' " + scene + " " +
                 file + sets);
  EXPECT_EQ(reader.exit_code, 0) << reader.output;
  EXPECT_NE(reader.output.find("agreed on 10 cells"), std::string::npos) << reader.output;

  // The same bytes again; with a threshold those that have it.
  expectRun(command + (files / "again.json"), 0, {});
  EXPECT_EQ(readText(files / "again.json"), readText(file));
  expectRun(command + (files / "least.json") + " --least 0.01", 0, {});
  auto expected = document;
  expected["least"] = 0.01;
  for (auto& cell : expected["cells"]) {
    auto objects = nlohmann::json::array();
    for (const auto& object : cell["objects"]) {
      if (object["share"] >= 0.01) objects.push_back(object);
    }
    EXPECT_LT(objects.size(), cell["objects"].size());
    cell["objects"] = objects;
  }
  EXPECT_EQ(nlohmann::json::parse(readText(files / "least.json")), expected);
}

TEST(ExportObjects, NamesObjectsOfOtherFormats) {
  const BoxInBox files;
  const std::string scene = files / "a.obj", pvs = files / "a.pvs";
  expectRun("bake " + scene + " --cells " + (files / "cells.json") + " -o " + pvs +
                " --device cpu --n-rand 50k --validation-rays 0",
            0, {});
  expectRun("export " + pvs + " --format objects --scene " + scene + " --device cpu --rays 20k -o " +
                (files / "o.json"),
            0, {"objects of 2 cells"});
  const auto document = nlohmann::json::parse(readText(files / "o.json"));
  const auto& gap = document["cells"][0];
  ASSERT_EQ(gap["objects"].size(), 2u);
  EXPECT_EQ(gap["objects"][1]["name"], "core");
  EXPECT_EQ(gap["objects"][1]["object"], 1);
  EXPECT_FALSE(gap["objects"][1].contains("node"));
  EXPECT_EQ(gap["hits"], 20'000);  // the shell is closed
  expectRun("export " + pvs + " --format objects -o " + (files / "o.json"), 2,
            {"--format objects needs --scene"});
  expectRun("export " + pvs + " --format objects --cell gap --scene " + scene + " -o " + (files / "o.json"),
            2, {"--format objects is of all cells"});
  expectRun("export " + pvs + " --format ids -o " + (files / "o.txt"), 2, {"--cell is required"});
}

}  // namespace
}  // namespace sightline
