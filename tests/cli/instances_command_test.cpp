// Instances as a user meets them: a plant of bays that repeat, what info and a bake's report say of it, and
// that --flatten makes no other set.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::Folder;
using test::ProgramRun;
using test::readText;
using test::runProgram;

/// The number that a bake's report has in its part on the scene.
uint64_t reported(const std::filesystem::path& report, const char* key) {
  return nlohmann::json::parse(readText(report))["scene"][key];
}

TEST(InstancesCommand, TheyAreSaidAndMakeTheSameSet) {
  const Folder folder;
  const auto path = [&](const char* name) { return "'" + (folder / name).string() + "'"; };
  const auto run = [](const std::string& arguments, std::initializer_list<const char*> parts) {
    const ProgramRun done = runProgram(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.output;
    for (const char* part : parts) {
      EXPECT_NE(done.output.find(part), std::string::npos) << part << "\n" << done.output;
    }
    return done.output;
  };
  run("scene plant -o " + path("p.glb") + " --triangles 1500000 --kinds 1", {"triangles are stored, in "});
  run("info " + path("p.glb"), {"instances", " meshes; "});
  EXPECT_EQ(run("info " + path("p.glb") + " --flatten", {}).find(" meshes; "), std::string::npos);
  folder.write("c.json", R"({"cells":[{"name":"aisle","center":[16,1.6,16],"size":[2.6,2.6,2.6]}]})");
  const std::string bake =
      "bake " + path("p.glb") + " --cells " + path("c.json") +
      " --device cpu --n-rand 2000 --validation-rays 1000 --max-rays 100000 --witnesses -o ";
  run(bake + path("a.pvs") + " --report " + path("a.json"), {"instances: ", "--flatten writes them out"});
  run(bake + path("b.pvs") + " --report " + path("b.json") + " --flatten", {});
  run("diff " + path("a.pvs") + " " + path("b.pvs"), {});  // witnesses and statistics as well
  EXPECT_GT(reported(folder / "a.json", "instances"), 100u);
  EXPECT_LT(reported(folder / "a.json", "stored_triangles"), reported(folder / "a.json", "triangles") / 4);
  EXPECT_EQ(reported(folder / "b.json", "instances"), 0u);
  EXPECT_EQ(reported(folder / "b.json", "stored_triangles"), reported(folder / "b.json", "triangles"));
  run("verify " + path("p.glb") + " " + path("a.pvs"), {});
}

TEST(InstancesCommand, OnlyWhatRepeatsHasKinds) {
  const Folder folder;
  const ProgramRun run = runProgram("scene bistro --kinds 2 -o '" + (folder / "b.glb").string() + "'");
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_NE(run.output.find("nothing that repeats"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace sightline
