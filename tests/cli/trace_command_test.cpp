// trace, and what crosscheck --reproduce writes for it, as a user runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/device/embree/embree_device.h"
#include "tests/cli/run_program.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using test::expectRun;
using test::ProgramRun;
using test::runProgram;

/// Two walls before the origin, the nearer one at z = -2.
class Walls {
 public:
  Walls() {
    std::ofstream(file_)
        << "v -1 -1 -4\nv 1 -1 -4\nv 0 1 -4\nv -1 -1 -2\nv 1 -1 -2\nv 0 1 -2\nf 1 2 3\nf 4 5 6\n";
  }
  std::string trace(const std::string& rest) const { return "trace '" + file_.string() + "' " + rest; }
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "walls.obj";
};

TEST(TraceCommand, AnswersOneRay) {
  const Walls walls;
  expectRun(walls.trace("--from 0,0,0 --along 0,0,-1 --devices cpu,opencl"), 0,
            {"exactly", "triangle 1 at 2\n", "cpu       triangle 1 at 0x1p+1: right",
             "opencl:0  triangle 1 at 0x1p+1: right"});
  expectRun(walls.trace("--from 0x00000000,0x0p+0,-3 --along 0,0,0xbf800000"), 0,
            {"0x0p+0 0x0p+0 -0x1.8p+1 along 0x0p+0 0x0p+0 -0x1p+0", "bits", "0xc0400000",
             "triangle 0 at 0x1p+0: right"});
  expectRun(walls.trace("--from -9,0,0 --along -1,0,-1e-3"), 0,
            {"exactly  nothing", "cpu      nothing: right"});
  const auto traced =
      nlohmann::json::parse(runProgram(walls.trace("--from 0,0,0 --along 0,0,-0.5 --json")).output);
  EXPECT_EQ(traced["answers"][0]["triangle"], 1);
  EXPECT_EQ(traced["answers"][0]["verdict"], "right");
  EXPECT_EQ(traced["exact_triangles"], nlohmann::json{1});
  EXPECT_EQ(traced["legal"], true);
  EXPECT_EQ(traced["direction"][2], "-0x1p-1");
}

TEST(TraceCommand, SaysWhatIsWrong) {
  const Walls walls;
  expectRun(walls.trace("--from 0,0,0 --along 0,0,0"), 2, {"--along: '0,0,0' is a direction of zero"});
  expectRun(walls.trace("--from 0,0,0 --along 0,0,1e-60"), 2, {"is a direction of zero"});
  expectRun(walls.trace("--from 0,0,0 --along nan,0,1"), 2, {"--along: 'nan,0,1' is not finite"});
  expectRun(walls.trace("--from 0,0x7f800000,0 --along 0,0,1"), 2,
            {"--from: '0,0x7f800000,0' is not finite"});
  expectRun(walls.trace("--from 0,0 --along 0,0,1"), 2, {"--from: '0,0' is not X,Y,Z"});
  expectRun(walls.trace("--from 3f708000,0,0 --along 0,0,1"), 2, {"is not X,Y,Z"});
  expectRun(walls.trace("--from 0,0,0"), 2, {"--along"});
  expectRun(walls.trace("--from 0,0,0 --along 0,0,1 --devices gpu9"), 2, {"gpu9"});
  expectRun(walls.trace("--from 0,0,0 --along 0,0,1 --devices cpu,cpu"), 2, {"cpu is named twice"});
  expectRun("trace nothing.obj --from 0,0,0 --along 0,0,1", 1, {"nothing.obj"});
}

TEST(CrosscheckCommand, ReproducesDisagreements) {
  if (!embreeDeviceInfo().unusable.empty()) GTEST_SKIP() << embreeDeviceInfo().unusable;
  const Walls folder;
  const std::string city = folder / "city.glb", cells = folder / "cells.json", out = folder / "out";
  runProgram("scene city -o " + city + " --triangles 3000 --cells " + cells);
  // Ties and edges: Embree names whichever it likes.
  const std::string start = "crosscheck " + city + " --cells " + cells + " --devices cpu,embree --rays 300 ";
  expectRun(start + "--kinds vertex --reproduce " + out, 0, {" written"});
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const std::string start_of_command = "# In this folder: sightline trace ";
    const size_t at = text.str().find(start_of_command);
    ASSERT_NE(at, std::string::npos) << text.str();
    if (++files > 5) continue;
    const size_t end = text.str().find('\n', at);
    const std::string command =
        text.str().substr(at + start_of_command.size(), end - at - start_of_command.size());
    const ProgramRun run = runProgram("trace " + out + "/" + command);
    EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 3) << run.output;
    for (const char* device : {"cpu", "embree"}) {  // "# cpu: triangle 4 at 0x1p+0 (right)"
      const size_t begin =
          text.str().find(std::string("\n# ") + device + ": ") + 5 + std::string(device).size();
      const std::string answer = text.str().substr(begin, text.str().find(" (", begin) - begin);
      EXPECT_NE(run.output.find("  " + answer + ": "), std::string::npos) << answer << "\n" << run.output;
    }
  }
  EXPECT_GT(files, 0u);
  EXPECT_LE(files, 100u);
  expectRun(start + "--kinds vertex --reproduce " + out, 1, {"is not empty", "--overwrite"});
  expectRun(start + "--kinds random --overwrite --reproduce " + out, 0, {"of an earlier run removed"});
}

TEST(TraceCommand, DirectionsBeyondWhatTracersTakeAreRefused) {
  const Walls walls;
  for (const char* direction : {"1e-30,0,0", "1e-38,1e-40,0", "1e20,1e20,0", "3e38,0,0"}) {
    expectRun(walls.trace(std::string("--from 0,0,0 --devices cpu --along ") + direction), 2,
              {"--along: ", "too short or too long", "scale it"});
  }
  expectRun(walls.trace("--from 0,0,0 --along 0,0,-0x1p-60 --devices cpu"), 0, {});
  expectRun(walls.trace("--from 0,0,0 --along 0,0,-0x1p60 --devices cpu"), 0, {});
}

TEST(TraceCommand, EmbreeIsAPeerAndBakesNothing) {
  const Walls folder;
  const std::string city = folder / "city.glb", cells = folder / "cells.json";
  runProgram("scene city -o " + city + " --triangles 1000 --cells " + cells);
  expectRun("devices", 0, {"embree", "for crosscheck and trace only"});
  expectRun("bake " + city + " --cells " + cells + " -o x.pvs --device embree", 2,
            {"embree traces rays for crosscheck and trace only; take cpu, opencl or vulkan"});
  if (!embreeDeviceInfo().unusable.empty()) GTEST_SKIP() << embreeDeviceInfo().unusable;
  expectRun(folder.trace("--from 0,0,0 --along 0,0,-1 --devices cpu,embree"), 0,
            {"embree   triangle 1 at 0x1p+1: right"});
  expectRun("crosscheck " + city + " --cells " + cells + " --devices cpu,embree --pvs", 2,
            {"--pvs: embree traces rays only"});
}

}  // namespace
}  // namespace sightline
