#include <gtest/gtest.h>

#include "core/scene/generate.h"
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

TEST(CellsCommand, PlacesAGridAndAPath) {
  const Folder folder;
  const auto scene = (folder / "city.glb").string(), cells = (folder / "cells.json").string();
  ASSERT_EQ(runProgram("scene city --triangles 2000 -o '" + scene + "'").exit_code, 0);
  const std::string start = "cells '" + scene + "' -o '" + cells + "' ";

  ProgramRun run = runProgram(start + "--grid 8,4,8 --max-height 1");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::vector<ViewCell> grid = loadCells(cells);
  EXPECT_GT(grid.size(), 50u);
  for (const ViewCell& cell : grid) EXPECT_EQ(cell.size, glm::dvec3(8, 4, 8));

  run = runProgram(start + "--grid 8 --free-side back");
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

TEST(CellsCommand, SaysWhatIsWrong) {
  const Folder folder;
  const auto scene = (folder / "city.glb").string();
  ASSERT_EQ(runProgram("scene city --triangles 1000 -o '" + scene + "'").exit_code, 0);
  const std::string start = "cells '" + scene + "' -o '" + (folder / "cells.json").string() + "' ";
  expectLine(start, 2, "--grid or --path");
  expectLine(start + "--grid 4 --path 0,0,0 1,1,1", 2, "--grid or --path");
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
