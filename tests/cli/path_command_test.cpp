// Camera paths and cells along them, as a user makes them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/cell/cell_contains.h"
#include "core/formats/cells_file.h"
#include "core/formats/walk_file.h"
#include "core/generate/generate.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::expectRun;
using test::Folder;

/// Two walls that cross the way from z = -10 to 10, in a file of large coordinates.
std::string twoWalls(double x) {
  std::string text;
  for (const double z : {-5.0, 5.0}) {
    text +=
        fmt::format("v {} -9 {}\nv {} -9 {}\nv {} 9 {}\nv {} 9 {}\n", x - 9, z, x + 9, z, x + 9, z, x - 9, z);
  }
  return text + "f 1 2 3 4\nf 5 6 7 8\n";
}

TEST(PathCommand, GoesThroughPointsAndNamesWhatIsInTheWay) {
  const Folder folder;
  const std::string where = (folder / "").string();
  for (const double x : {0.0, 5'000'000.0}) {
    const auto scene = folder.write("walls.obj", twoWalls(x));
    expectRun(
        fmt::format("path {} -o {}w.json --overwrite --frames 41 --through {},0,-10 {},0,10", scene.string(),
                    where, x, x),
        0,
        {"warning: the eye goes through surfaces 2 times, first after frame", "w.json: 41 frames, 0 cuts"});
    const CameraPath path = loadWalk(where + "w.json");
    EXPECT_EQ(path.frames(), 41u);
    EXPECT_LT(glm::length(placeAt(path, 20).eye - glm::dvec3(x, 0, 0)), 0.25);  // half a frame
  }
  const auto scene = folder.write("walls.obj", twoWalls(0));
  expectRun("path " + scene.string() + " -o " + where + "w.json --frames 41 --through 0,0,-10 0,0,10", 1,
            {"is there already"});
  const auto free = expectRun(
      "path " + scene.string() + " -o - --fov 90 --frames 41 --through 0,0,-10 0,0,-6", 0, {"\"fov\": 90.0"});
  EXPECT_EQ(free.output.find("warning"), std::string::npos) << free.output;
  expectRun("path " + scene.string() + " -o - --frames 41 --through 0,0,-10", 2,
            {"path: takes two different points or more"});
  expectRun("path " + scene.string() + " -o - --frames 1e7 --through 0,0,-10 0,0,1", 2,
            {"--frames: 1e7 is not a whole number from 2 to 1000000"});
  expectRun("path " + scene.string() + " -o - --frames 10 --through 0,0 0,0,1", 2,
            {"--through: '0,0' has 2 numbers, expected x,y,z"});
}

TEST(SceneCommand, WritesAWalk) {
  const Folder folder;
  const std::string where = (folder / "").string();
  expectRun(
      "scene plant -o " + where + "p.glb --triangles 5000 --seed 3 --walk " + where + "w.json --frames 90", 0,
      {"w.json: 90 frames"});
  EXPECT_EQ(loadWalk(where + "w.json"), generateWalk("plant", 5000, 3, 90));
  expectRun("scene plant -o " + where + "q.glb --walk " + where + "q.json --frames 59", 2,
            {"--frames: 59 is not a whole number from 60 to 1000000"});
}

TEST(CellsCommand, HoldsAWholeWalk) {
  const Folder folder;
  const std::string where = (folder / "").string();
  expectRun("scene city -o " + where + "c.glb --triangles 5000 --walk " + where + "w.json --frames 200", 0,
            {});
  expectRun("cells " + where + "c.glb -o " + where + "cells.json --walk " + where +
                "w.json --length 25 --width 2.5 --height 2",
            0, {"view cells"});
  const std::vector<ViewCell> cells = loadCells(where + "cells.json");
  const CameraPath path = loadWalk(where + "w.json");
  for (uint32_t frame = 0; frame < path.frames(); ++frame) {
    EXPECT_TRUE(std::ranges::any_of(cells, [&](const ViewCell& c) {
      return cellContains(c, placeAt(path, frame).eye);
    })) << frame;
  }
  const std::string cells_of = "cells " + where + "c.glb -o - ";
  expectRun(cells_of + "--walk " + where + "w.json --grid 3", 2,
            {"takes one of --grid, --floor, --path and --walk"});
  expectRun(cells_of + "--grid 3 --width 3", 2,
            {"--width: is of boxes along a --path or --walk, and neither is given"});
  expectRun(cells_of + "--walk " + where + "none.json", 1, {"none.json"});
  const auto bad = folder.write("bad.json", R"({"keys":[{"frame":0,"eye":[0,1,2],"look":[0,1,2]}]})");
  expectRun(cells_of + "--walk " + bad.string(), 2,
            {"bad.json: keys[0].look: is the eye's place; there is nothing to look at"});
}

}  // namespace
}  // namespace sightline
