#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/cli/run_program.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::runProgram;

/// A closed room of two triangles a wall, and one cell in it, baked on the processor.
class PictureCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "room.obj") << "v -4 -2 -3\nv 4 -2 -3\nv 4 2 -3\nv -4 2 -3\nv -4 -2 3\nv 4 -2 3\n"
                                           "v 4 2 3\nv -4 2 3\nf 1 2 3 4\nf 5 6 7 8\nf 1 5 8 4\nf 2 6 7 3\n"
                                           "f 1 2 6 5\nf 4 3 7 8\n";
    std::ofstream(folder_ / "cells.json")
        << R"({"cells":[{"name":"middle","center":[0,0,0],"size":[1,0.5,0.5]}]})";
    const ProgramRun bake =
        runProgram(fmt::format("bake {} --cells {} -o {} --device cpu --n-rand 20000 --validation-rays 1000",
                               path("room.obj"), path("cells.json"), path("room.pvs")));
    ASSERT_EQ(bake.exit_code, 0) << bake.output;
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  ProgramRun picture(const std::string& arguments) const {
    return runProgram(fmt::format("picture {} {} --device cpu --width 64 --height 48 {}", path("room.obj"),
                                  path("room.pvs"), arguments));
  }

  TemporaryFolder folder_;
};

void expectFailure(const ProgramRun& run, int exit_code, const std::string& part) {
  EXPECT_EQ(run.exit_code, exit_code) << run.output;
  EXPECT_NE(run.output.find(part), std::string::npos) << run.output;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
}

TEST_F(PictureCommand, DrawsBothViews) {
  for (const char* view : {"outside", "inside"}) {
    const std::string file = path(std::string(view) + ".png");
    const ProgramRun run = picture(fmt::format("--cell middle --view {} -o {}", view, file));
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_NE(run.output.find(fmt::format("middle from {}, 12 of 12 triangles", view)), std::string::npos)
        << run.output;
    EXPECT_GT(std::filesystem::file_size(file), 100u);
  }
}

TEST_F(PictureCommand, CountsTheRedPixels) {
  const ProgramRun run = picture(fmt::format("--cell 0 --view inside -o {}", path("a.png")));
  EXPECT_NE(run.output.find("\n0 of 2768 pixels show a triangle outside the set (red)\n"), std::string::npos)
      << run.output;
}

TEST_F(PictureCommand, SaysWhatIsWrong) {
  expectFailure(picture("--cell attic -o " + path("a.png")), 2,
                "no baked cell \"attic\"; there are 1: middle");
  expectFailure(picture("--cell 0 -o " + path("no/such/a.png")), 1, path("no/such/a.png"));
  expectFailure(picture("--cell 0 --cut high -o " + path("a.png")), 2,
                "--cut: must be auto, none or a height");
  expectFailure(picture("--cell 0 --view above -o " + path("a.png")), 2, "above");
  std::ofstream(folder_ / "room.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  expectFailure(picture("--cell 0 -o " + path("a.png")), 1, "was baked of another scene");
  EXPECT_FALSE(std::filesystem::exists(path("a.png")));
}

}  // namespace
}  // namespace sightline
