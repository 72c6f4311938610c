// What cells cannot see, as a user proves it, and what is done with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/pvs/pvs_file.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::expectRun;
using test::Folder;

std::string textOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class BoundCommand : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// A city, two cells in it, and their bound.
  void makeCity() {
    expectRun("scene city -o " + path("c.glb") + " --triangles 20000 --cells " + path("all.json"), 0, {});
    auto cells = nlohmann::json::parse(textOf(path("all.json")));
    auto& list = cells["cells"];
    for (size_t i = list.size(); i-- > 0;) {
      if (list[i]["name"] != "box-1" && list[i]["name"] != "box-3") list.erase(i);
    }
    std::ofstream(path("cells.json")) << cells;
    expectRun(
        "bound " + path("c.glb") + " --cells " + path("cells.json") + " --voxel 0.5 -o " + path("u.pvs"), 0,
        {"voxels of 0.5", "box-1: ", "are proved hidden"});
  }
  std::string bake(const std::string& file, const std::string& options) const {
    return "bake " + path("c.glb") + " --cells " + path("cells.json") + " -o " + path(file) +
           " --device cpu --n-rand 300k --validation-rays 100k --witnesses " + options;
  }

  Folder folder_;
};

// Right: the set within the bound is that without it, but for what is outside of the bound, which is listed.
TEST_F(BoundCommand, LimitsABakeAndIsVerified) {
  makeCity();
  expectRun(bake("plain.pvs", ""), 0, {});
  expectRun(bake("limited.pvs",
                 "--bound " + path("u.pvs") + " --html " + path("l.html") + " --report " + path("l.json")),
            0, {"box-1: ", " seen, ", " open, ", " hidden: ", "of what is not seen is proved hidden"});
  const PvsFile upper = loadPvs(path("u.pvs")), plain = loadPvs(path("plain.pvs")),
                limited = loadPvs(path("limited.pvs"));
  const auto states = nlohmann::json::parse(textOf(path("l.json")))["cells"][0]["states"];
  EXPECT_EQ(states["seen"], limited.cells[0].triangles.size());
  EXPECT_EQ(states["open"], upper.cells[0].triangles.size() - limited.cells[0].triangles.size());
  EXPECT_EQ(states["hidden"], upper.triangle_count - upper.cells[0].triangles.size());
  EXPECT_NE(textOf(path("l.html")).find("Within the bound"), std::string::npos);
  EXPECT_EQ(upper.params.method, Method::kBound);
  EXPECT_EQ(upper.params.bound, 0.5f);
  EXPECT_EQ(limited.params.bound, 0.5f);
  EXPECT_EQ(limited.version, 6u);
  EXPECT_EQ(plain.version, 4u);
  for (size_t i = 0; i < plain.cells.size(); ++i) {
    const std::vector<uint32_t>&all = plain.cells[i].triangles, &bound = upper.cells[i].triangles;
    std::vector<uint32_t> within;
    std::set_intersection(all.begin(), all.end(), bound.begin(), bound.end(), std::back_inserter(within));
    EXPECT_EQ(limited.cells[i].triangles, within);
    EXPECT_EQ(limited.cells[i].witnesses.size(), within.size());
    EXPECT_GT(within.size(), 100u);
    EXPECT_LT(bound.size(), plain.triangle_count * 3 / 4);
  }
  expectRun("verify " + path("c.glb") + " " + path("plain.pvs") + " --bound " + path("u.pvs") + " --report " +
                path("v.json"),
            0, {"outside the bound, each shown by an exact ray"});
  const auto report = nlohmann::json::parse(textOf(path("v.json")));
  EXPECT_EQ(report["bound"].size(), 2u);
  EXPECT_TRUE(report["bound"][0]["unexplained"].empty());
  expectRun("info " + path("u.pvs"), 0, {"bound 0.5", "format version 6"});
  expectRun(bake("limited.pvs", "--bound " + path("u.pvs")), 0, {"already complete", " seen, "});
  expectRun(bake("limited.pvs", ""), 1, {"bound (0.5 there, 0 now)"});
}

// A bound without a triangle that is seen is wrong, and verify says so.
TEST_F(BoundCommand, VerifyFindsAWrongBound) {
  makeCity();
  expectRun(bake("plain.pvs", ""), 0, {});
  PvsFile upper = loadPvs(path("u.pvs"));
  const PvsFile plain = loadPvs(path("plain.pvs"));
  const uint32_t seen = plain.cells[0].triangles[plain.cells[0].triangles.size() / 2];
  std::erase(upper.cells[0].triangles, seen);
  savePvs(upper, path("wrong.pvs"));
  expectRun("verify " + path("c.glb") + " " + path("plain.pvs") + " --bound " + path("wrong.pvs"), 3,
            {"bound or set is wrong", std::to_string(seen)});
}

TEST_F(BoundCommand, TakesVoxelsOfAFile) {
  makeCity();
  expectRun("voxels " + path("c.glb") + " --voxel 0.5 -o " + path("c.slv"), 0, {});
  const std::string bound =
      "bound " + path("c.glb") + " --cells " + path("cells.json") + " -o " + path("v.pvs");
  expectRun(bound + " --voxels " + path("c.slv") + " --leaks " + path("l.json") + " --rays 100k", 0,
            {"outside the bound"});
  const PvsFile a = loadPvs(path("u.pvs")), b = loadPvs(path("v.pvs"));
  EXPECT_EQ(a.cells[0].triangles, b.cells[0].triangles);
  const auto leaks = nlohmann::json::parse(textOf(path("l.json")));
  EXPECT_EQ(leaks["cells"].size(), 2u);
  EXPECT_EQ(leaks["bound"], 0.5);
  for (const auto& cell : leaks["cells"]) EXPECT_TRUE(cell["unexplained"].empty());
  expectRun("voxels " + path("c.glb") + " --voxel 0.5 --separate 6 -o " + path("six.slv"), 0, {});
  expectRun(bound + " --overwrite --voxels " + path("six.slv"), 2,
            {"make it with voxels --separate conservative"});
  expectRun("voxels " + path("c.glb") + " --voxel 0.5 --solid reach -o " + path("solid.slv"), 0, {});
  expectRun("info " + path("solid.slv"), 0, {"what is inside of them is in the set, too"});
  expectRun(bound + " --overwrite --voxels " + path("solid.slv"), 2, {"make it with voxels without --solid"});
  expectRun(bound + " --voxels " + path("c.slv") + " --voxel 0.5", 2, {"--voxel"});
}

TEST_F(BoundCommand, RefusesInOneLine) {
  makeCity();
  expectRun(bake("a.pvs", "--bound " + path("u.pvs") + " --seed 2"), 0, {});
  expectRun(bake("b.pvs", "--bound " + path("a.pvs")), 2,
            {"a.pvs: is no bound: make one with sightline bound"});
  expectRun(bake("b.pvs", "--bound " + path("u.pvs") + " --see-through 'tree*'"), 2,
            {"the same --see-through"});
  expectRun(bake("b.pvs", "--bound " + path("u.pvs") + " --doors 'tree*'"), 2, {"bake without --doors"});
  expectRun(bake("b.pvs", "--method bound"), 2, {"bound is none of"});
  EXPECT_EQ(expectRun("verify " + path("c.glb") + " " + path("a.pvs") + " --bound " + path("a.pvs"), 2,
                      {"a.pvs: is no bound"})
                .output.find("box-1"),
            std::string::npos);  // before the work
  expectRun(
      "bound " + path("c.glb") + " --cells " + path("cells.json") + " -o " + path("v.pvs") + " --rays 9", 2,
      {"--rays requires --leaks"});
  std::string cells = textOf(path("cells.json"));
  cells.replace(cells.find("1.7"), 3, "1.8");
  std::ofstream(path("other.json")) << cells;
  expectRun("bake " + path("c.glb") + " --cells " + path("other.json") + " --device cpu -o " + path("b.pvs") +
                " --bound " + path("u.pvs"),
            2, {"has no cell box-1 in this place"});
  expectRun("scene city -o " + path("d.glb") + " --triangles 5000", 0, {});
  expectRun("bake " + path("d.glb") + " --cells " + path("cells.json") + " --device cpu -o " + path("b.pvs") +
                " --bound " + path("u.pvs"),
            2, {"is the bound of another scene"});
}

// A wall without an inside: nothing is proved, and that is said.
TEST_F(BoundCommand, SaysWhereNothingIsProved) {
  const std::string scene = folder_
                                .write("w.obj",
                                       "v 4 -9 -9\nv 4 9 -9\nv 4 9 9\nv 4 -9 9\nv 20 -30 -30\nv 20 30 0\nv "
                                       "20 -30 30\nf 1 2 3 4\nf 5 6 7\n")
                                .string();
  const std::string cells =
      folder_.write("w.json", R"({"cells": [{"name": "a", "center": [0, 0, 0], "size": [1, 1, 1]}]})")
          .string();
  expectRun("bound " + scene + " --cells " + cells + " --voxel 0.5 -o " + path("w.pvs"), 0,
            {"a: nothing is proved, as no voxel is opaque", "All triangles may be seen"});
  EXPECT_EQ(loadPvs(path("w.pvs")).cells[0].triangles.size(), 3u);
}

}  // namespace
}  // namespace sightline
