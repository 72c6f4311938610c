// .pvs files of bakes with doors: what is in them, what is wrong with them, and going on with them.
#include <gtest/gtest.h>

#include "core/bake/bake.h"
#include "core/diff/pvs_diff.h"
#include "core/diff/pvs_diff_report.h"
#include "core/pvs/door_state.h"
#include "core/pvs/pvs_sections.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

PvsFile doorsPvs(bool witnesses = true) {
  PvsFile pvs = examplePvs(witnesses);
  pvs.params.smallest_hole = 0.25f;
  pvs.doors = {{"door", 5, 1}, {"d\xc3\xb6\x72", 10, 90}};
  pvs.see_through = {{"glass", 400, 2}};
  const std::vector<std::vector<uint32_t>> added = {{3, 4, 299, 301}, {}};
  for (size_t i = 0; i < 2; ++i) {
    const CellPvs open = exampleCell(pvs.planned[i], added[i], witnesses);
    pvs.cells[i].open = OpenSet{open.stats, open.triangles, open.witnesses};
    pvs.cells[i].open->stats.random.rays = 1234;
    pvs.cells[i].open->stats.seconds = 0.75;
  }
  return pvs;
}

Bytes bytesOf(const PvsFile& pvs) {
  Bytes all;
  writePvs(pvs, [&](const Bytes& bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); });
  return all;
}

TEST(DoorsFile, ReadsWhatItWrites) {
  for (const bool witnesses : {false, true}) {
    const PvsFile pvs = doorsPvs(witnesses), got = parsePvs(bytesOf(pvs), "x.pvs");
    EXPECT_EQ(got.version, 5u);
    EXPECT_EQ(got.doors, pvs.doors);
    EXPECT_EQ(got.see_through, pvs.see_through);
    EXPECT_EQ(got.params, pvs.params);
    ASSERT_EQ(got.cells.size(), 2u);
    EXPECT_EQ(got.cells[0].triangles, pvs.cells[0].triangles);
    EXPECT_EQ(got.cells[0].open->triangles, (std::vector<uint32_t>{3, 4, 299, 301}));
    EXPECT_EQ(got.cells[0].open->stats.random.rays, 1234u);
    EXPECT_EQ(got.cells[0].open->stats.seconds, 0.75);
    EXPECT_EQ(got.cells[0].open->witnesses.size(), witnesses ? 4u : 0u);
    EXPECT_EQ(got.cells[0].witnesses.size(), witnesses ? 7u : 0u);
    EXPECT_TRUE(got.cells[1].open->triangles.empty());
    EXPECT_EQ(bytesOf(got), bytesOf(pvs));
  }
}

TEST(DoorsFile, EveryTruncationIsAnError) {
  Bytes bytes = bytesOf(doorsPvs());
  while (!bytes.empty()) {
    bytes.pop_back();
    EXPECT_THROW(parsePvs(bytes, "x.pvs"), BadPvs) << bytes.size();
  }
}

TEST(DoorsFile, OthersAreWrittenAsBefore) {
  EXPECT_EQ(versionOf(examplePvs()), 4u);
  EXPECT_EQ(bytesOf(examplePvs())[8], 4);
  EXPECT_EQ(bytesOf(doorsPvs())[8], 5);
}

std::string headProblem(auto change) {
  PvsFile pvs = doorsPvs();
  change(pvs);
  try {
    readHeadPayload(writeHeadPayload(pvs), 5);
  } catch (const Damage& damage) {
    return damage.what();
  }
  return "";
}

TEST(DoorsFile, RefusesDoorsThatAreNone) {
  EXPECT_EQ(headProblem([](PvsFile&) {}), "");
  EXPECT_EQ(headProblem([](PvsFile& f) { f.doors[1].first = 5; }), "objects that do not ascend");
  EXPECT_EQ(headProblem([](PvsFile& f) { f.doors[0].count = 0; }), "objects that do not ascend");
  EXPECT_EQ(headProblem([](PvsFile& f) { f.doors[1].count = 991; }), "an object beyond the scene");
  EXPECT_EQ(headProblem([](PvsFile& f) { f.doors[1].count = ~0u; }), "an object beyond the scene");
}

TEST(DoorsFile, WhatOpensIsNotInTheClosedSet) {
  PvsFile pvs = doorsPvs(false);
  pvs.cells[0].open->triangles[0] = 2;
  EXPECT_THROW(parsePvs(bytesOf(pvs), "x.pvs"), BadPvs);
  pvs.cells[0].open.reset();
  EXPECT_THROW(bytesOf(pvs), Error) << "a cell without the set that its doors need";
}

TEST(DoorsFile, StatesAreWhatTheySay) {
  const PvsFile pvs = doorsPvs();
  const CellPvs open = inState(pvs.cells[0], DoorState::kOpen),
                closed = inState(pvs.cells[0], DoorState::kClosed);
  EXPECT_EQ(closed.triangles, pvs.cells[0].triangles);
  EXPECT_EQ(open.triangles, (std::vector<uint32_t>{0, 1, 2, 3, 4, 7, 299, 300, 301, 998, 999}));
  ASSERT_EQ(open.witnesses.size(), open.triangles.size());
  for (size_t i = 0; i < open.triangles.size(); ++i) {
    EXPECT_EQ(open.witnesses[i].origin.x, float(open.triangles[i]));
  }
  EXPECT_EQ(doorStateOf("open"), DoorState::kOpen);
  EXPECT_EQ(doorStateOf("ajar"), std::nullopt);
  EXPECT_THROW(inState(examplePvs(), DoorState::kOpen, "x.pvs"), Error);
}

TEST(DoorsFile, ABakeGoesOnWithTheSameDoorsOnly) {
  const PvsFile pvs = doorsPvs();
  PvsFile other = pvs;
  EXPECT_TRUE(inputDifferences(pvs, other).empty());
  other.doors[0].count = 2;
  ASSERT_EQ(inputDifferences(pvs, other).size(), 1u);
  EXPECT_EQ(inputDifferences(pvs, other)[0], "doors (of the same names, but of other triangles)");
  other.doors.clear();
  EXPECT_EQ(inputDifferences(pvs, other)[0], "doors (door, d\xc3\xb6r there, none now)");
}

TEST(DoorsFile, StoppedBakesGoOn) {
  const TemporaryFolder folder;
  PvsFile inputs = doorsPvs();
  const std::vector<CellPvs> cells = {inputs.cells[0], inputs.cells[1], inputs.cells[0]};
  inputs.cells.clear();
  std::atomic<bool> stop = false;
  const CellBaker baker = [&](const ViewCell& cell, uint32_t index, const ProgressCallback&) {
    stop = index == 0;
    CellPvs pvs = cells[index];
    pvs.cell = cell;
    return pvs;
  };
  BakeEvents events;
  events.stop = &stop;
  EXPECT_FALSE(Bake(inputs, folder / "x.pvs").run("cpu", baker, events));
  stop = false;
  Bake again(inputs, folder / "x.pvs");
  EXPECT_EQ(again.resumed(), 1u);
  events.stop = nullptr;
  EXPECT_TRUE(again.run("cpu", baker, events));
  EXPECT_EQ(again.finished()[0].open_added, 4u);
  EXPECT_TRUE(Bake(inputs, folder / "y.pvs").run("cpu", baker));
  EXPECT_EQ(bytesBeforeCosts(folder / "x.pvs"), bytesBeforeCosts(folder / "y.pvs"));
  EXPECT_EQ(loadPvs(folder / "x.pvs").cells[2].open->triangles, cells[2].open->triangles);
}

TEST(DoorsFile, DiffsSeeWhatOpeningAdds) {
  const PvsFile a = doorsPvs();
  PvsFile b = a;
  EXPECT_TRUE(diffPvs(a, b).same());
  b.cells[0].open->triangles[3] = 302;
  const PvsDiff diff = diffPvs(a, b);
  EXPECT_FALSE(diff.same());
  ASSERT_EQ(diff.cells.size(), 1u);
  EXPECT_EQ(diffLines(diff),
            (std::vector<std::string>{"cell a: 1 triangle (301) with open doors in A only",
                                      "cell a: 1 triangle (302) with open doors in B only"}));
  b.doors.clear();
  EXPECT_EQ(diffPvs(a, b).inputs[0].name, "doors");
}

TEST(DoorsFile, TheResultsHashHoldsBothSets) {
  const PvsFile a = doorsPvs();
  PvsFile b = a;
  b.cells[0].open->triangles[0] = 5;
  EXPECT_NE(hashResult(summarize(a)), hashResult(summarize(b)));
}

}  // namespace
}  // namespace sightline
