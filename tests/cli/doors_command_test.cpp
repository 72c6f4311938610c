// Doors, objects that hide nothing, and gaps, as a user of the program meets them.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/cli/run_program.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

using test::expectRun;

/// A hall with a door, which fills its far side, and a wall behind it; a slit of 1 mm in the near side, with
/// a wall behind that.
class DoorsCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "hall.obj")
        << "v -4 -2 -3\nv 4 -2 -3\nv 4 2 -3\nv -4 2 -3\nv -4 -2 3\nv 4 -2 3\nv 4 2 3\nv -4 2 3\n"
           "v -4 -2 6\nv 4 -2 6\nv 4 2 6\nv -4 2 6\nv 0 -2 -3\nv 0.001 -2 -3\nv 0.001 2 -3\nv 0 2 -3\n"
           "v -4 -2 -9\nv 4 -2 -9\nv 4 2 -9\nv -4 2 -9\n"
           "o hall/near\nf 1 13 16 4\nf 14 2 3 15\no hall/sides\nf 1 5 8 4\nf 2 6 7 3\nf 1 2 6 5\nf 4 3 7 8\n"
           "o front door\nf 5 6 7 8\no garden\nf 9 10 11 12\no street\nf 17 18 19 20\n";
    std::ofstream(folder_ / "cells.json")
        << R"({"cells":[{"name":"middle","center":[0,0,0],"size":[1,0.5,0.5]}]})";
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string bake(const std::string& name, const std::string& options) const {
    return fmt::format("bake {} --cells {} -o {} --device cpu --n-rand 200000 --validation-rays 1000 {}",
                       path("hall.obj"), path("cells.json"), path(name), options);
  }
  std::string exported(const std::string& name, const std::string& options) const {
    return expectRun(fmt::format("export {} --cell 0 --format ids -o - {}", path(name), options), 0, {})
        .output;
  }

  TemporaryFolder folder_;
};

constexpr const char* kHall = "0\n1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n12\n13\n";
constexpr const char* kGarden = "14\n15\n";

TEST_F(DoorsCommand, ClosedAndOpenThroughAllCommands) {
  const std::string pvs = path("a.pvs"), scene = path("hall.obj");
  expectRun(bake("a.pvs", "--doors '*door' --smallest-hole 0.01 --witnesses"), 0,
            {"doors: 1 object of 2 triangles"});
  expectRun("info " + pvs, 0,
            {"front door (from triangle 12, 2 of them)", "middle: 2 more triangles", "version 5"});
  EXPECT_EQ(exported("a.pvs", "").find(kHall), 0u);
  EXPECT_EQ(exported("a.pvs", "").find(kGarden), std::string::npos);
  EXPECT_EQ(exported("a.pvs", "--doors open").find(std::string(kHall) + kGarden), 0u);
  for (const char* state : {"closed", "open"}) {
    const std::string files = scene + " " + pvs + " --doors " + state;
    expectRun("verify " + files, 0, {"100.00000 % of the witnesses prove their triangle, 0 are disproved"});
    expectRun("picture " + files + " --cell 0 --view inside --device cpu --width 64 --height 48 -o " +
                  path("a.png"),
              0, {});
    expectRun("measure " + files + " --device cpu --views 20 --resolution 50", 0, {"all cells"});
  }
  expectRun("diff " + pvs + " " + pvs, 0, {"the same"});
  expectRun(bake("a.pvs", "--doors '*door' --smallest-hole 0.01 --witnesses"), 0, {"already complete"});
  expectRun(bake("a.pvs", "--smallest-hole 0.01 --witnesses"), 1, {"doors (front door there, none now)"});
}

TEST_F(DoorsCommand, ObjectsThatHideNothing) {
  expectRun(bake("b.pvs", "--see-through 'front*' --smallest-hole 0.01"), 0, {});
  EXPECT_EQ(exported("b.pvs", "").find(std::string(kHall) + kGarden), 0u);
  expectRun("info " + path("b.pvs"), 0, {"hides nothing    front door"});
  expectRun("measure " + path("hall.obj") + " " + path("b.pvs") + " --device cpu --views 20 --resolution 50",
            0, {});
  expectRun("export " + path("b.pvs") + " --cell 0 --format ids -o - --doors open", 2, {"without doors"});
}

TEST_F(DoorsCommand, TellsOfLeaksAndClosesThem) {
  const std::string cells = R"({"cells":[{"name":"middle","center":[0,0,0],"size":[2,0.5,0.5]}]})";
  std::ofstream(folder_ / "cells.json") << cells;
  expectRun(bake("c.pvs", ""), 0,
            {"seen only through gaps narrower than 0.002", "-3); --smallest-hole 0.002 closes"});
  EXPECT_NE(exported("c.pvs", "").find("16\n17\n"), std::string::npos) << "the street";
  const std::string closed = expectRun(bake("d.pvs", "--smallest-hole 0.002"), 0, {}).output;
  EXPECT_EQ(closed.find("seen only"), std::string::npos);
  EXPECT_EQ(exported("d.pvs", "").find("16\n17\n"), std::string::npos);
}

TEST_F(DoorsCommand, NamesThatAreNotThere) {
  expectRun(bake("e.pvs", "--doors 'front dor'"), 2,
            {"--doors: no object of the scene is named front dor; did you mean front door?"});
  expectRun(bake("e.pvs", "--see-through 'x*'"), 2,
            {"there are hall/near, hall/sides, front door, garden, street"});
  expectRun(bake("e.pvs", "--smallest-hole 1 --target-error 0.1"), 2, {"with smallest-hole use threshold"});
  expectRun(bake("e.pvs", "--smallest-hole -1"), 2, {"--smallest-hole"});
}

}  // namespace
}  // namespace sightline
