// export and picture of a voxel file, as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/formats/load_scene.h"
#include "core/voxel/voxel_faces.h"
#include "core/voxel/voxel_file.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::runProgram;

class VoxelOutputs : public testing::Test {
 protected:
  VoxelOutputs() {
    expectDone("scene scan -o '" + path("a.glb") + "' --triangles 5000");
    expectDone("voxels '" + path("a.glb") + "' -o '" + path("a.slv") + "' --voxel 0.125");
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  static std::string expectDone(const std::string& arguments) {
    const ProgramRun run = runProgram(arguments);
    EXPECT_EQ(run.exit_code, 0) << arguments << "\n" << run.output;
    return run.output;
  }
  static void expectUsageError(const std::string& arguments, const std::string& part) {
    const ProgramRun run = runProgram(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.output;
    EXPECT_NE(run.output.find(part), std::string::npos) << run.output;
    EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
  }

  const test::Folder folder_;
};

TEST_F(VoxelOutputs, ExportWritesTheFacesOfALevel) {
  const VoxelFile voxels = loadVoxels(path("a.slv"));
  for (const char* format : {"glb", "obj", "ply"}) {
    for (const uint32_t level : {0u, 2u}) {
      for (const bool merge : {false, true}) {
        const std::string file = path("b.") + format;
        expectDone("export '" + path("a.slv") + "' --format " + format + " -o '" + file + "' --level " +
                   std::to_string(level) + (merge ? " --merge" : ""));
        const Scene expected =
            voxelScene(voxels.levels.at(level), merge ? FaceMerging::kBlocks : FaceMerging::kNone);
        const Scene got = loadScene(file);
        ASSERT_EQ(got.triangleCount(), expected.triangleCount()) << format << " " << level << " " << merge;
        EXPECT_EQ(got.positions, expected.positions) << format;
        EXPECT_EQ(sceneBounds(got).high, sceneBounds(expected).high);
      }
    }
  }
}

TEST_F(VoxelOutputs, PictureDrawsALevel) {
  std::string before;
  for (const char* options : {"--level 0", "--level 1", "--cut 2", "--level 1 --cut 2",
                              "--cut 2 --reach 0,9,0", "--level 1 --cut 2 --reach 0,2,0"}) {
    expectDone("picture '" + path("a.slv") + "' " + options + " -o '" + path("a.png") +
               "' --device cpu --width 160 --height 120");
    const std::string picture = test::readText(folder_ / "a.png");
    EXPECT_EQ(picture.substr(1, 3), "PNG");
    EXPECT_NE(picture, before) << options;
    before = picture;
  }
}

TEST_F(VoxelOutputs, SayWhatIsWrong) {
  const std::string voxels = "'" + path("a.slv") + "'", out = " -o '" + path("x.ply") + "'";
  expectUsageError("export " + voxels + " --format ids" + out, "voxels are written as glb, obj, ply or vdb");
  expectUsageError("export " + voxels + " --format ply --level 31" + out,
                   "there is no level 31: the coarsest is ");
  expectUsageError("export " + voxels + " --format glb" + out, "must end with .glb");
  expectUsageError("export a.pvs --cell 0 --format ply" + out, "--format ply is of voxels (.slv)");
  expectUsageError("picture " + voxels + " --level 31 --device cpu -o '" + path("x.png") + "'",
                   "there is no level 31");
  expectUsageError("picture " + voxels + " --cell 0 --device cpu -o '" + path("x.png") + "'",
                   "without a set, a cell");
  expectUsageError("picture " + voxels + " --bound a.pvs --device cpu -o '" + path("x.png") + "'",
                   "without a set, a cell, a bound");
  expectUsageError("picture a.glb " + voxels + " --cell 0 --device cpu -o '" + path("x.png") + "'",
                   "a.slv: holds voxels, which are drawn without a scene");
  expectUsageError("picture a.glb a.pvs --cell 0 --level 1 --device cpu -o '" + path("x.png") + "'",
                   "--level: is of voxels (.slv) only");
  expectUsageError("export " + voxels + " --format ply --cell 0" + out, "--cell is of sets");
  expectUsageError("export " + voxels + " --format ply --scene a.glb" + out, "--scene is of sets");
  expectUsageError("export " + voxels + " --format ply -o -", "where voxels cannot go");
  expectUsageError("export a.pvs --cell 0 --format ids --merge" + out, "--merge is of voxels (.slv)");
  expectUsageError("export a.pvs --cell 0 --format ids --level 1" + out, "--level is of voxels (.slv)");
  expectUsageError("picture a.glb --cell 0 --device cpu -o '" + path("x.png") + "'", "pvs is required");
  expectUsageError("picture a.glb a.pvs --device cpu -o '" + path("x.png") + "'", "--cell is required");
  EXPECT_FALSE(std::filesystem::exists(path("x.ply")));
  EXPECT_FALSE(std::filesystem::exists(path("x.png")));
}

}  // namespace
}  // namespace sightline
