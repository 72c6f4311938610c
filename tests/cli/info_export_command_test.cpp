#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/pvs/param_table.h"
#include "tests/cli/run_program.h"
#include "tests/output/example_pvs.h"
#include "tests/output/version_3_file.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::readText;
using test::runProgram;

/// A scene of two named quads, its saved set {0, 3}, and cells.
class Files {
 public:
  Files() {
    std::ofstream(scene()) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\n"
                              "o near\nf 1 2 3 4\no far\nf 5 6 7 8\n";
    std::ofstream(cells()) << R"({"cells":[{"name":"spot","center":[0,0,9],"size":[1,1,0]}]})";
    PvsFile file;
    const Scene loaded = loadScene(scene());
    file.scene_hash = hashScene(loaded);
    file.triangle_count = uint32_t(loaded.triangles.size());
    file.scene_name = "quads.obj";
    file.device = "cpu";
    file.planned = loadCells(cells());
    file.cells = {exampleCell(file.planned[0], {0, 3}, false)};
    savePvs(file, pvs());
  }
  std::string scene() const { return (folder_ / "quads.obj").string(); }
  std::string cells() const { return (folder_ / "cells.json").string(); }
  std::string pvs() const { return (folder_ / "x.pvs").string(); }
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
};

void expectSays(const std::string& arguments, std::initializer_list<const char*> parts) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  for (const char* part : parts)
    EXPECT_NE(run.output.find(part), std::string::npos) << part << "\n" << run.output;
}

void expectFails(const std::string& arguments, int exit_code, const std::string& part) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.output;
  EXPECT_NE(run.output.find(part), std::string::npos) << arguments << "\n" << run.output;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
}

TEST(Program, SaysItsVersionAndCommands) {
  expectSays("--version", {"sightline "});
  expectSays("--help", {"bake", "info", "export", "devices"});
  expectSays("devices", {"cpu"});
  expectFails("nonsense", 2, "--help");
}

TEST(InfoCommand, DescribesScenesCellsAndSets) {
  const Files files;
  expectSays("info " + files.scene(),
             {"triangles        4", "vertices         8", "(0, 0, 0) to (1, 1, 5)", "near", "far"});
  expectSays("info " + files.cells(), {"1 in", "spot", "flat"});
  expectSays("info " + files.pvs(), {"quads.obj, 4 triangles", "1 of 1 baked", "spot", "50.00 %", "seed"});
}

TEST(InfoCommand, HintsAtMillimetres) {
  const Files files;
  std::ofstream(files / "mm.obj") << "v 0 0 0\nv 3000 0 0\nv 3000 2500 0\nf 1 2 3\n";
  expectSays("info " + (files / "mm.obj"), {"extent           3000 x 2500 x 0, median edge 3000\n",
                                            "hint             looks like millimetres"});
  EXPECT_EQ(runProgram("info " + files.scene()).output.find("hint"), std::string::npos);
}

TEST(FarScenes, KeepTheirFilesCoordinates) {
  const Files files;
  std::ofstream(files / "far.obj") << "v 500000.1 35 4649776.2\nv 500000.3 35 4649776.2\n"
                                      "v 500000.3 35.2 4649776.2\nv 500000.1 35.2 4649776.2\nf 1 2 3 4\n";
  const std::string scene = files / "far.obj", pvs = files / "far.pvs", cells = files / "far.json";
  expectSays("cells " + scene + " -o " + cells + " --width 0.1 --height 0.1 --length 1 --path " +
                 "500000.2,35.1,4649777 500000.2,35.1,4649778",
             {"1 view cells"});
  const auto cell = nlohmann::json::parse(readText(cells))["cells"][0];
  EXPECT_NEAR(cell["center"][0].get<double>(), 500000.2, 1e-6);
  EXPECT_NEAR(cell["center"][2].get<double>(), 4649777.5, 1e-6);
  expectSays("bake " + scene + " --cells " + cells + " -o " + pvs +
                 " --device cpu --n-rand 10000 --validation-rays 1000 --report " + (files / "r.json"),
             {"100.00 %"});
  const auto report = nlohmann::json::parse(readText(files / "r.json"));
  EXPECT_EQ(report["scene"]["offset"], nlohmann::json({500000.0, 35.0, 4649776.0}));
  EXPECT_NEAR(report["cells"][0]["center"][2].get<double>(), 4649777.5, 1e-6);
  expectSays("info " + pvs, {"offset           (500000, 35, 4649776), taken off"});
  expectSays("export " + pvs + " --cell 0 --format json -o " + (files / "x.json"), {"2 triangles"});
  EXPECT_NEAR(nlohmann::json::parse(readText(files / "x.json"))["cell"]["center"][0].get<double>(), 500000.2,
              1e-6);
  expectSays("export " + pvs + " --cell 0 --format obj --scene " + scene + " -o " + (files / "x.obj"),
             {"2 triangles"});
  EXPECT_NE(readText(files / "x.obj").find("\nv 500000.3"), std::string::npos) << readText(files / "x.obj");
}

TEST(IgnoreExtension, OfEveryCommandThatLoads) {
  const Files files;
  std::ofstream(files / "a.gltf")
      << R"({"asset":{"version":"2.0"},"extensionsRequired":["ACME_x"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
      << R"({"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5121,"count":3,"type":)"
      << R"("VEC3"}],"bufferViews":[{"buffer":0,"byteLength":9}],"buffers":[{"byteLength":9,"uri":)"
      << R"("data:;base64,AAAAAQAAAAEA"}]})";
  const std::string scene = files / "a.gltf";
  expectFails("info " + scene, 1, "--ignore-extension");
  expectSays("info " + scene + " --ignore-extension ACME_x", {"triangles        1"});
  expectSays("bake " + scene + " --ignore-extension ACME_x --cells " + files.cells() + " -o " +
                 (files / "a.pvs") + " --device cpu --n-rand 1000 --validation-rays 0 --report " +
                 (files / "r.json"),
             {"1 triangles"});
  EXPECT_EQ(nlohmann::json::parse(readText(files / "r.json"))["features"]["ignored_extensions"][0], "ACME_x");
  for (const std::string& command :
       {"export " + (files / "a.pvs") + " --cell 0 --format json -o " + (files / "a.json") + " --scene " +
            scene,
        "picture " + scene + " " + (files / "a.pvs") + " --cell 0 --device cpu -o " + (files / "a.png"),
        "trace " + scene + " --from 0,0,9 --along 0,0,-1",
        "cells " + scene + " -o " + (files / "c.json") + " --path 0,0,5 0,0,9"}) {
    expectFails(command, 1, "ACME_x");
    EXPECT_EQ(runProgram(command + " --ignore-extension ACME_x").exit_code, 0) << command;
  }
}

TEST(InfoCommand, AndABakeSayWhatOfASceneIsOtherwise) {
  const Files files;
  std::ofstream(files / "m.mtl") << "newmtl pane\nd 0.4\n";
  std::ofstream(files / "far.obj")
      << "mtllib m.mtl\nusemtl pane\nv 4649776.1 0 0\nv 4649776.2 0 0\nv 4649776.1 0.1 0\n"
         "f 1 2 3\nusemtl wall\nv 4649777 0 0\nv 4649777 2 0\nv 4649777 0 2\nf 4 5 6\n"
         "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 7 8 9\n";
  const std::string lost = "of 3 triangles 1 lose their area by that and 0 turn by more than 30 degrees";
  expectSays("info " + (files / "far.obj"),
             {"glass            1 triangles", "warning          single precision", lost.c_str()});
  expectSays("bake " + (files / "far.obj") + " --cells " + files.cells() + " -o " + (files / "far.pvs") +
                 " --device cpu --n-rand 1000 --validation-rays 1000 --report " + (files / "r.json") +
                 " --html " + (files / "r.html"),
             {"warning: single precision steps by 0.5", lost.c_str()});
  const auto scene = nlohmann::json::parse(readText(files / "r.json"))["scene"];
  EXPECT_EQ(scene["glass_triangles"], 1);
  EXPECT_EQ(scene["surfaces"]["see_through_triangles"], 1);
  EXPECT_EQ(scene["surfaces"]["masked_triangles"], 0);
  EXPECT_EQ(scene["hidden_nodes"], 0);
  ASSERT_EQ(scene["warnings"].size(), 1u);
  EXPECT_NE(scene["warnings"][0].get<std::string>().find(lost), std::string::npos);
  EXPECT_NE(readText(files / "r.html").find(lost), std::string::npos);
}

TEST(InfoCommand, FailsOnDamagedAndMissingFiles) {
  const Files files;
  expectFails("info " + (files / "none.pvs"), 1, "none.pvs");
  auto bytes = readBytes(files.pvs());
  bytes[bytes.size() / 2] ^= 1;
  writeBytes(files / "flipped.pvs", bytes);
  expectFails("info " + (files / "flipped.pvs"), 1, "damaged");
  writeBytes(files / "text.pvs", {'v', ' ', '0', '\n'});
  expectFails("info " + (files / "text.pvs"), 1, "text.pvs: not a .pvs file");
  bytes[8] = 99;
  writeBytes(files / "version.pvs", bytes);
  expectFails("info " + (files / "version.pvs"), 1, "version 99");
  EXPECT_EQ(std::system(("'" SL_PROGRAM "' info " + files.scene() + " > /dev/full 2>/dev/null").c_str()),
            1 << 8);
  EXPECT_EQ(std::system(("'" SL_PROGRAM "' info " + files.scene() + " | true").c_str()), 0);
}

/// Whatever reads a .pvs file refuses a cell that no ray can leave.
TEST(InfoCommand, CellsWithoutAreaAreNeitherShownNorMeasured) {
  const Files files;
  PvsFile pvs = loadPvs(files.pvs());
  pvs.planned[0].size = {0, 0, 1};
  savePvs(pvs, files / "line.pvs");
  const std::string reason = "cells[0].size: the cell has no area";
  expectFails("info " + (files / "line.pvs"), 1, reason);
  expectFails("measure " + files.scene() + " " + (files / "line.pvs") + " --device cpu", 1, reason);
  expectFails("export " + (files / "line.pvs") + " --cell 0 --format ids -o " + (files / "x.txt"), 1, reason);
}

TEST(InfoCommand, SaysOfWhichFormatAndAlgorithmASetIs) {
  const Files files;
  PvsFile pvs = loadPvs(files.pvs());
  pvs.algorithm = 5;
  savePvs(pvs, files / "exact.pvs");
  expectSays("info " + (files / "exact.pvs"), {"format version 4", "algorithm        revision 5\n"});
  pvs.intersector = "GPU, driver 5";
  savePvs(pvs, files / "driver.pvs");
  expectSays("info " + (files / "driver.pvs"), {"revision 5, intersection test of GPU, driver 5\n"});
  writeBytes(files / "old.pvs", kVersion3File);
  expectSays("info " + (files / "old.pvs"), {"format version 3", "revision 1\n", "2 of 3 baked"});
}

TEST(InfoCommand, ShowsEachParameter) {
  const Files files;
  PvsFile pvs = loadPvs(files.pvs());
  const std::string before = runProgram("info " + files.pvs()).output;
  for (const Param& param : kParams) {
    PvsFile other = pvs;
    std::visit(
        [&](const auto& field) {
          auto& value = other.params.*field.member;
          value = value == field.low ? field.high : field.low;
        },
        param.field);
    savePvs(other, files / "other.pvs");
    // Before what follows it: "n_rand 1" is in "n_rand 10000000", too.
    const std::string value = shownText(param, other.params);
    const bool own_row = paramGroupName(param.group) == param.name;
    const std::string shown =
        own_row ? fmt::format("\n{:<16} {}\n", param.name, value) : fmt::format(" {} {}", param.name, value);
    const auto shows = [&](const std::string& text) {
      return text.find(shown + (own_row ? "" : ",")) != std::string::npos ||
             text.find(shown + (own_row ? "" : "\n")) != std::string::npos;
    };
    EXPECT_FALSE(shows(before)) << shown;
    const std::string after = runProgram("info " + (files / "other.pvs")).output;
    EXPECT_TRUE(shows(after)) << shown << "\n" << after;
  }
}

/// Of a file without even a head there is nothing to say; of one that was cut off later, what is there.
TEST(InfoCommand, SaysWhatATornPartFileHolds) {
  const Files files;
  const auto bytes = readBytes(files.pvs());
  for (const size_t size : {size_t(0), size_t(10), size_t(16), size_t(60)}) {
    writeBytes(files / "torn.pvs.part", {bytes.begin(), bytes.begin() + ptrdiff_t(size)});
    expectFails("info " + (files / "torn.pvs.part"), 1, "torn.pvs.part: holds no bake yet: ");
  }
  writeBytes(files / "cut.pvs.part", {bytes.begin(), bytes.end() - 200});
  expectSays("info " + (files / "cut.pvs.part"), {"0 of 1 baked"});
}

TEST(ExportCommand, WritesIdsAndJson) {
  const Files files;
  expectSays("export " + files.pvs() + " --cell spot --format ids -o " + (files / "x.txt"), {"2 triangles"});
  EXPECT_EQ(readText(files / "x.txt"), "0\n3\n");
  expectSays("export " + files.pvs() + " --cell 0 --format json -o " + (files / "x.json") + " --scene " +
                 files.scene(),
             {});
  const auto exported = nlohmann::json::parse(readText(files / "x.json"));
  EXPECT_EQ(exported["ids"], (nlohmann::json{0, 3}));
  EXPECT_EQ(exported["cell"]["name"], "spot");
  EXPECT_EQ(exported["objects"][1]["name"], "far");
  EXPECT_EQ(exported["objects"][1]["visible"], 1);
}

TEST(ExportCommand, WritesTheVisibleTrianglesAsAScene) {
  const Files files;
  for (const std::string format : {"obj", "glb"}) {
    const std::string out = files / ("visible." + format);
    expectSays(fmt::format("export {} --cell spot --format {} -o {} --scene {}", files.pvs(), format, out,
                           files.scene()),
               {"2 triangles"});
    const Scene all = loadScene(files.scene()), visible = loadScene(out);
    ASSERT_EQ(visible.triangles.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      for (int corner = 0; corner < 3; ++corner) {
        EXPECT_EQ(visible.positions[visible.triangles[i][corner]],
                  all.positions[all.triangles[i == 0 ? 0 : 3][corner]]);
      }
    }
    ASSERT_EQ(visible.objects.size(), 2u);
    EXPECT_EQ(visible.objects[0].name, "near");
    EXPECT_EQ(visible.objects[1].name, "far");
  }
}

TEST(ExportCommand, SaysWhatItNeeds) {
  const Files files;
  const std::string start = "export " + files.pvs() + " --cell ";
  expectFails(start + "spot --format obj -o " + (files / "x.obj"), 2, "--scene");
  expectFails(start + "spot --format obj -o " + (files / "x.glb") + " --scene " + files.scene(), 2, ".obj");
  expectFails(start + "other --format ids -o " + (files / "x.txt"), 2, "spot");
  expectFails(start + "spot --format png -o " + (files / "x.png"), 2, "--format");
  expectFails(start + "spot --format ids -o " + (files / "none/x.txt"), 1, "none/x.txt");
  std::ofstream(files / "other.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  expectFails(start + "spot --format obj -o " + (files / "x.obj") + " --scene " + (files / "other.obj"), 1,
              "another scene");
}

/// A slip in a file's name must not cost the scene, the cells or the bake.
TEST(OutputFiles, NeverReplaceWhatIsRead) {
  const Files files;
  const std::string scene = readText(files.scene()), cells = readText(files.cells()),
                    pvs = readText(files.pvs());
  const auto quick = fmt::format("bake {} --cells {} --device cpu --n-rand 1000 --validation-rays 0 ",
                                 files.scene(), files.cells());
  expectFails(quick + "-o " + files.scene(), 2, "would be read and replaced");
  expectFails(quick + "-o " + files.pvs() + " --report " + files.scene(), 2, "would be read and replaced");
  expectFails(quick + "-o " + files.pvs() + " --report " + files.cells(), 2, "would be read and replaced");
  expectFails(quick + "-o " + (files / "n.pvs") + " --report " + (files / "n.pvs"), 2,
              "would be written twice");
  expectFails(quick + "-o " + (files / "n.pvs") + " --report " + (files / "n.pvs.part"), 2,
              "would be written twice");
  expectFails(quick + "-o " + (files / "n.pvs") + " --pictures " + (files / "n.pvs"), 2,
              "would be written twice");
  const std::array<std::filesystem::path, 2> spellings = {"n.pvs", "./n.pvs"};
  EXPECT_THROW(requireSeparate(spellings, {}), Error);
  expectFails("export " + files.pvs() + " --cell 0 --format ids -o " + files.pvs(), 2, "read and replaced");
  expectFails("cells " + files.scene() + " --path 0,0,9 5,0,9 -o " + files.scene(), 2, "read and replaced");
  expectFails("scene city -o " + (files / "n.obj") + " --cells " + (files / "n.obj"), 2, "written twice");
  const std::string verify = "verify " + files.scene() + " " + files.pvs();
  expectFails(verify + " -o " + files.scene(), 2, "read and replaced");
  expectFails(verify + " --report " + files.pvs(), 2, "read and replaced");
  expectFails("crosscheck " + files.scene() + " --cells " + files.cells() + " --devices cpu --report " +
                  files.cells(),
              2, "read and replaced");
  std::filesystem::create_symlink(files.scene(), files / "link.png");
  expectFails("picture " + files.scene() + " " + files.pvs() + " --cell 0 -o " + (files / "link.png"), 2,
              "read and replaced");
  EXPECT_EQ(readText(files.scene()), scene);
  EXPECT_EQ(readText(files.cells()), cells);
  EXPECT_EQ(readText(files.pvs()), pvs);
}

TEST(OutputFiles, DevicesAndPipesAreNeitherReplacedNorWaitedFor) {
  const Files files;
  ASSERT_EQ(::mkfifo((files / "pipe").c_str(), 0600), 0);
  const std::string ids = "export " + files.pvs() + " --cell 0 --format ids -o ";
  expectFails(ids + (files / "pipe"), 1, "is not a regular file");
  expectFails(ids + "/dev/null", 1, "is not a regular file");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  const std::string bake = "bake " + files.scene() + " --cells " + files.cells() + " --device cpu -o ";
  expectFails(bake + (files / "pipe"), 1, "is not a regular file");
  std::filesystem::create_symlink(files / "pipe", files / "pipe.obj");
  expectFails("info " + (files / "pipe.obj"), 1, "is not a regular file");
}

TEST(OutputFiles, ALinkIsFollowed) {
  const Files files;
  std::filesystem::create_symlink(files / "ids.txt", files / "link.txt");
  expectSays("export " + files.pvs() + " --cell 0 --format ids -o " + (files / "link.txt"), {"2 triangles"});
  EXPECT_TRUE(std::filesystem::is_symlink(files / "link.txt"));
  EXPECT_EQ(readText(files / "ids.txt"), "0\n3\n");
}

}  // namespace
}  // namespace sightline
