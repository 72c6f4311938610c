#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/generate/generate.h"
#include "core/io/file_io.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::Folder;
using test::ProgramRun;
using test::runProgram;

/// Usage or failure: one line, that names what is wrong.
void expectLine(const std::string& arguments, int exit_code, const std::string& part) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.output;
  EXPECT_NE(run.output.find(part), std::string::npos) << arguments << "\n" << run.output;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
  EXPECT_EQ(run.output.rfind("sightline: ", 0), 0u) << run.output;
}

TEST(SceneCommand, WritesWhatGenerateSceneMakes) {
  const Folder folder;
  for (const std::string extension : {".obj", ".glb"}) {
    const auto file = folder / ("scene" + extension), cells = folder / "cells.json";
    for (const GeneratedSceneInfo& info : generatedScenes()) {
      const ProgramRun run =
          runProgram("scene " + info.name + " -o '" + file.string() +
                     "' --triangles 2000 --seed 7 --overwrite --cells '" + cells.string() + "'");
      ASSERT_EQ(run.exit_code, 0) << run.output;
      const Scene expected = generateScene(info.name, 2'000, 7), got = loadScene(file);
      EXPECT_EQ(hashScene(got), hashScene(expected)) << info.name;
      ASSERT_EQ(got.objects.size(), expected.objects.size());
      EXPECT_EQ(got.objects.back().name, expected.objects.back().name);
      const std::vector<ViewCell> placed = loadCells(cells), wanted = generateCells(info.name, 2'000, 7);
      ASSERT_EQ(placed.size(), wanted.size());
      for (size_t i = 0; i < placed.size(); ++i) {
        EXPECT_EQ(placed[i].name, wanted[i].name);
        EXPECT_EQ(placed[i].center, wanted[i].center);
        EXPECT_EQ(placed[i].size, wanted[i].size);
        EXPECT_EQ(placed[i].rotation, wanted[i].rotation);
      }
    }
  }
}

TEST(SceneCommand, SaysWhatIsWrong) {
  const Folder folder;
  const std::string out = " -o '" + (folder / "x.obj").string() + "'";
  expectLine("scene village" + out, 2, "city, canyon, plant");
  expectLine("scene city --triangles 999" + out, 2, "1000..20000000");
  expectLine("scene city --triangles 20000001" + out, 2, "1000..20000000");
  expectLine("scene city --triangles many" + out, 2, "many");
  expectLine("scene city", 2, "--output");
  expectLine("scene city --triangles 1000 -o '" + (folder / "x.stl").string() + "'", 1, "x.stl");
  expectLine("scene city --triangles 1000 -o /nonexistent/x.obj", 1, "/nonexistent/x.obj");
}

TEST(CellsCommand, PlacesWhatIsReachedAndTheFloor) {
  const Folder folder;
  const auto scene = (folder / "city.glb").string(), cells = (folder / "cells.json").string();
  ASSERT_EQ(runProgram("scene city --triangles 2000 -o '" + scene + "'").exit_code, 0);
  const std::string start = "cells '" + scene + "' -o '" + cells + "' --overwrite ";

  ProgramRun run = runProgram(start + "--grid 8,4,8 --max-height 1 --reach 0,1.5,0");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_NE(run.output.find("voxels of 0.5: "), std::string::npos) << run.output;
  EXPECT_NE(run.output.find(" % of space is reached"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find(" not reached"), std::string::npos) << run.output;
  EXPECT_GT(loadCells(cells).size(), 50u);

  run = runProgram(start + "--floor 20 --least 2 --reach 0,1.5,0 --voxel 0.5");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_NE(run.output.find(" % of it"), std::string::npos) << run.output;
  EXPECT_GT(loadCells(cells).size(), 50u);
  for (const ViewCell& cell : loadCells(cells)) {
    EXPECT_LE(cell.size.x, 20);
    EXPECT_LE(cell.size.z, 20);
  }
  const auto picture = (folder / "floor.png").string();
  run = runProgram(start + "--floor 20 --least 2 --voxel 0.5 --picture '" + picture + "'");
  EXPECT_TRUE(std::filesystem::exists(picture));
  ASSERT_EQ(run.exit_code, 0) << run.output;

  expectLine(start + "--grid 8 --reach 0,1.5,0 --voxel 0.3", 2, "take 0.25 or 0.5");
  expectLine(start + "--grid 8 --voxel 0.5", 2, "--reach and --floor");
  expectLine(start + "--grid 8 --reach 0,-0.01,0", 2, "triangles meet");
  expectLine(start + "--floor 20 --reach 0,500,0 --least 50", 2, "least");
  expectLine(start + "--floor 20 --eye 5", 2, "head");
  expectLine(start + "--floor nan", 2, "nan");
  expectLine(start + "--floor 20 --picture floor.jpg", 2, ".png");
  // Before the work: one line, and no cells.
  expectLine("cells '" + scene + "' -o '" + (folder / "no.json").string() +
                 "' --floor 20 --least 2 --picture /nonexistent/floor.png",
             1, "/nonexistent/floor.png");
  EXPECT_FALSE(std::filesystem::exists(folder / "no.json"));
  expectLine(start + "--floor 20 --step -1", 2, "--step: -1 is not 0 or a number above");
  expectLine(start + "--grid 8 --floor 8", 2, "takes one of");
  expectLine(start + "--path 0,1,0 0,1,9 --reach 0,1.5,0", 2, "--reach");
  expectLine(start + "--path 0,1,0 0,1,9 --free-side any", 2, "--free-side");
  expectLine(start + "--grid 8 --least 1", 2, "--floor");
}

TEST(CellsCommand, PlacesAGridAndAPath) {
  const Folder folder;
  const auto scene = (folder / "city.glb").string(), cells = (folder / "cells.json").string();
  ASSERT_EQ(runProgram("scene city --triangles 2000 -o '" + scene + "'").exit_code, 0);
  const std::string start = "cells '" + scene + "' -o '" + cells + "' --overwrite ";

  ProgramRun run = runProgram(start + "--grid 8,4,8 --max-height 1");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::vector<ViewCell> grid = loadCells(cells);
  EXPECT_GT(grid.size(), 50u);
  for (const ViewCell& cell : grid) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(cell.size[axis], axis == 1 ? 4 : 8);
      EXPECT_GE(cell.size[axis], (axis == 1 ? 4 : 8) - 0.1601) << "4 margins of 0.04 at most";
    }
  }
  run = runProgram(start + "--grid 8,4,8 --max-height 1 --margin 0");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  for (const ViewCell& cell : loadCells(cells)) EXPECT_EQ(cell.size, glm::dvec3(8, 4, 8));

  run = runProgram(start + "--grid 8 --free-side back --margin 0");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(loadCells(cells).at(0).size, glm::dvec3(8));

  run = runProgram(start + "--path -5.5,1.5,-60 -5.5,1.5,60 -1,1.5,60 --width 2 --length 50");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::vector<ViewCell> path = loadCells(cells);
  ASSERT_EQ(path.size(), 4u);
  EXPECT_NEAR(path[1].center.x, -5.5, 1e-9);
  EXPECT_NEAR(path[1].center.z, 0, 1e-9);
  EXPECT_NEAR(path[1].size.z, 40, 1e-9);

  folder.write("points.txt", "# a street\n-5.5,1.5,-60\n-5.5,1.5,60 # its end\n\n-1,1.5,60\n");
  run = runProgram(start + "--path '" + (folder / "points.txt").string() + "' --width 2 --length 50");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::vector<ViewCell> again = loadCells(cells);
  ASSERT_EQ(again.size(), path.size());
  for (size_t i = 0; i < path.size(); ++i) EXPECT_EQ(again[i].center, path[i].center);
}

/// The inside of a box of 8 x 4 x 6, which a post stands in.
std::string roomWithAPost(const Folder& folder) {
  std::string text;
  auto box = [&text, vertices = 0](std::array<double, 3> low, std::array<double, 3> high) mutable {
    for (int corner = 0; corner < 8; ++corner) {
      text += fmt::format("v {} {} {}\n", (corner & 1 ? high : low)[0], (corner & 2 ? high : low)[1],
                          (corner & 4 ? high : low)[2]);
    }
    for (const auto& f :
         {std::array{1, 2, 4, 3}, {5, 7, 8, 6}, {1, 5, 6, 2}, {3, 4, 8, 7}, {1, 3, 7, 5}, {2, 6, 8, 4}}) {
      text +=
          fmt::format("f {} {} {} {}\n", vertices + f[0], vertices + f[1], vertices + f[2], vertices + f[3]);
    }
    vertices += 8;
  };
  box({0, 0, 0}, {8, 4, 6});
  box({4.4, 0, 2.5}, {5.4, 4, 3.5});
  return folder.write("room.obj", text).string();
}

TEST(CellsCommand, ReplacesOnlyWhenAsked) {
  const Folder folder;
  const std::string scene = roomWithAPost(folder);
  const std::string cells = folder.write("cells.json", "mine").string();
  expectLine("cells " + scene + " -o " + cells + " --grid 2", 1, "cells.json: is there already");
  EXPECT_EQ(std::string(readFile(cells).view()), "mine");
  EXPECT_EQ(runProgram("cells " + scene + " -o " + cells + " --grid 2 --free-side any --overwrite").exit_code,
            0);
  EXPECT_GT(loadCells(cells).size(), 10u);
}

TEST(CellsCommand, WritesToStandardOutputAndNothingElseThere) {
  const Folder folder;
  const std::string scene = roomWithAPost(folder);
  const std::string file = (folder / "cells.json").string(), piped = (folder / "piped.json").string();
  const std::string grid = " --grid 2 --free-side any";
  ASSERT_EQ(runProgram("cells " + scene + " -o " + file + grid).exit_code, 0);
  ProgramRun run =
      runProgram("cells " + scene + " -o -" + grid + " >" + piped + " 2>/dev/null || exit 9; true");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(std::string(readFile(piped).view()), std::string(readFile(file).view()));
  EXPECT_FALSE(std::filesystem::exists("-"));
  run = runProgram("cells " + scene + " -o -" + grid + " >/dev/full");
  EXPECT_EQ(run.exit_code, 1) << run.output;
}

TEST(CellsCommand, BoundsTheGrid) {
  const Folder folder;
  const std::string scene = roomWithAPost(folder), cells = (folder / "cells.json").string();
  const auto place = [&](const std::string& options) {
    const ProgramRun run =
        runProgram("cells " + scene + " -o " + cells + " --overwrite --free-side any --margin 0 " + options);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    return loadCells(cells);
  };
  std::vector<ViewCell> placed = place("--grid 1 --origin 1,0.5,1");
  EXPECT_EQ(placed[0].name, "grid-0-0-0");
  EXPECT_EQ(placed[0].center, glm::dvec3(1.5, 1, 1.5));
  EXPECT_EQ(placed.size(), 3u * (7 * 5 - 4)) << "all but those in the post";
  placed = place("--grid 1 --origin 1,0.5,1 --count 2 1 1");
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed[1].center, glm::dvec3(2.5, 1, 1.5));
  placed = place("--grid 1 --region 0.5,0.5,0.5 2.5,1.5,1.5");
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed[1].center, glm::dvec3(2, 1, 1));

  const std::string start = "cells " + scene + " -o " + (folder / "new.json").string() + " ";
  expectLine(start + "--grid 1 --region 1,1,1 0,2,2", 2, "region");
  expectLine(start + "--grid 1 --region 1,1,1 0,2", 2, "--region");
  expectLine(start + "--grid 1 --count 1 2", 2, "--count");
  expectLine(start + "--grid 1 --count 1 0 2", 2, "1 or more");
  expectLine(start + "--grid 1 --count 1 -1 2", 2, "--count");
  expectLine(start + "--grid 1 --origin 9,0,0", 2, "lower the origin");
  expectLine(start + "--grid 1 --margin 0.2", 2, "an eighth");
  expectLine(start + "--path 1,1,1 2,1,1 --count 1 1 1", 2, "--grid");
  expectLine(start + "--grid 1 --width 2", 2, "--path");
}

TEST(CellsCommand, PathsKeepClearOfTrianglesOrSayWhichCannot) {
  const Folder folder;
  const std::string scene = roomWithAPost(folder), cells = (folder / "cells.json").string();
  const std::string path =
      "cells " + scene + " -o " + cells + " --overwrite --path 1,1,3 7,1,3 --width 1 --height 2 --length 2 ";
  ProgramRun run = runProgram(path);
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_NE(run.output.find("warning: path-2 is left out: "), std::string::npos) << run.output;
  ASSERT_EQ(loadCells(cells).size(), 2u);
  EXPECT_EQ(loadCells(cells)[1].name, "path-3");
  EXPECT_NEAR(loadCells(cells)[1].size.z, 7 - 5.4 - 0.01, 1e-6) << "beside the post";
  EXPECT_NEAR(loadCells(cells)[0].size.y, 1.99, 1e-9) << "above the floor";
  run = runProgram(path + "--margin 0");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(loadCells(cells).size(), 3u);
  expectLine("cells " + scene + " -o " + cells + " --overwrite --path 5,1,2.6 5,1,3.4 --width 2", 1,
             "path-1");
}

TEST(CellsCommand, AGridShowsProgressAndCanBeStopped) {
  const Folder folder;
  const std::string scene = roomWithAPost(folder), cells = (folder / "cells.json").string();
  const std::string log = (folder / "log").string();
  const auto text = [&] { return std::string(readFile(log).view()); };
  test::Running grid("cells " + scene + " -o " + cells + " --grid 0.028 --free-side any", log);
  for (int i = 0; i < 1200 && (!std::filesystem::exists(log) || text().find("grid: ") == std::string::npos);
       ++i) {
    ::usleep(25'000);
  }
  grid.send(SIGINT);
  EXPECT_EQ(grid.wait(), 130) << text();
  EXPECT_NE(text().find(" boxes, "), std::string::npos) << text();
  EXPECT_NE(text().find("stopped: no cells are written"), std::string::npos) << text();
  EXPECT_FALSE(std::filesystem::exists(cells));
}

TEST(CellsCommand, SaysWhatIsWrong) {
  const Folder folder;
  const auto scene = (folder / "city.glb").string();
  ASSERT_EQ(runProgram("scene city --triangles 1000 -o '" + scene + "'").exit_code, 0);
  const std::string start = "cells '" + scene + "' -o '" + (folder / "cells.json").string() + "' ";
  expectLine(start, 2, "one of --grid, --floor, --path and --walk");
  expectLine(start + "--grid 4 --path 0,0,0 1,1,1", 2, "one of --grid, --floor, --path and --walk");
  expectLine(start + "--grid 4,5", 2, "x,y,z");
  expectLine(start + "--grid 4,a,5", 2, "4,a,5");
  expectLine(start + "--grid 0", 2, "positive");
  expectLine(start + "--grid 0.001", 2, "larger");
  expectLine(start + "--grid 4 --free-side up", 2, "up");
  expectLine(start + "--path 0,0,0", 2, "two different points");
  expectLine(start + "--path 0,0,0 0,0,inf", 2, "0,0,inf");
  expectLine(start + "--path 0,0,0 0,0,9 --width 0", 2, "positive");
  expectLine(start + "--path " + (folder / "none.txt").string(), 2, "none.txt");
  const std::string points = folder.write("points.txt", "0,0,0\n1,2\n").string();
  expectLine(start + "--path " + points, 2, "points.txt:2");
  expectLine("cells /nonexistent.obj -o /tmp/x.json --grid 4", 1, "/nonexistent.obj");
  // One box over everything: the city is in it.
  expectLine(start + "--grid 5000", 1, "no free box");
}

}  // namespace
}  // namespace sightline
