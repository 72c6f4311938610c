// `sightline diff`: the same, or where not.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/pvs/param_table.h"
#include "core/pvs/pvs_writer.h"
#include "tests/cli/run_program.h"
#include "tests/cli/run_separately.h"
#include "tests/output/example_pvs.h"
#include "tests/output/version_3_file.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::runProgram;
using test::runSeparately;

class Diff : public testing::Test {
 protected:
  /// Compares the example with one in which `change` changed something.
  ProgramRun afterChange(const std::function<void(PvsFile&)>& change, const std::string& options = "") const {
    PvsFile pvs = examplePvs();
    savePvs(pvs, folder_ / "a.pvs");
    change(pvs);
    savePvs(pvs, folder_ / "b.pvs");
    return runProgram(
        fmt::format("diff {} {} {}", (folder_ / "a.pvs").string(), (folder_ / "b.pvs").string(), options));
  }

  void expectSame(const std::function<void(PvsFile&)>& change) const {
    const ProgramRun run = afterChange(change);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_EQ(run.output, "the same: 2 cells, 7 triangles in their sets\n");
  }

  void expectDifferent(const std::function<void(PvsFile&)>& change, const std::string& line) const {
    const ProgramRun run = afterChange(change);
    EXPECT_EQ(run.exit_code, 3) << run.output;
    EXPECT_NE(run.output.find(line + "\n"), std::string::npos) << line << "\n" << run.output;
    EXPECT_NE(run.output.find("different: in "), std::string::npos) << run.output;
  }

  TemporaryFolder folder_;
};

TEST_F(Diff, WhatABakeCostsIsNoDifference) {
  expectSame([](PvsFile&) {});
  expectSame([](PvsFile& pvs) {
    pvs.device = pvs.cells[0].device = "another";
    pvs.scene_name = "renamed.obj";
    CellStats& stats = pvs.cells[0].stats;
    stats.seconds = stats.random.seconds = stats.border.seconds = stats.reverse.seconds = 99;
    stats.peak_device_bytes = 5;
  });
}

TEST_F(Diff, FindsEachDifferenceOfTheInputs) {
  expectDifferent([](PvsFile& f) { f.algorithm = 8; }, "revision of the algorithm: 7 in A, 8 in B");
  expectDifferent([](PvsFile& f) { f.intersector = ""; },
                  "intersection test: of GPU, driver 5 in A, of cpu and opencl in B");
  expectDifferent([](PvsFile& f) { f.scene_hash ^= 1; },
                  "hash of the scene: 0123456789abcdef in A, 0123456789abcdee in B");
  expectDifferent([](PvsFile& f) { f.triangle_count = 1001; },
                  "triangles of the scene: 1000 in A, 1001 in B");
  expectDifferent([](PvsFile& f) { f.planned.pop_back(); }, "planned cells: 3 in A, 2 in B");
  expectDifferent(
      [](PvsFile& f) { f.planned.pop_back(); },
      "planned cell c: number 2, center (9, 0, 0) size (1, 1, 1) rotation (0, 45, 0) in A, none in B");
  expectDifferent(
      [](PvsFile& f) {
        f.planned.push_back({"d", {1, 2, 3}, {1, 1, 1}, {}});
      },
      "planned cell d: none in A, number 3, center (1, 2, 3) size (1, 1, 1) rotation (0, 0, 0) in B");
  expectDifferent(
      [](PvsFile& f) { f.planned[2].size.x = 1.5; },
      "planned cell c: number 2, center (9, 0, 0) size (1, 1, 1) rotation (0, 45, 0) in A, number 2, "
      "center (9, 0, 0) size (1.5, 1, 1) rotation (0, 45, 0) in B");
  expectDifferent(
      [](PvsFile& f) {
        f.has_witnesses = false;
        for (CellPvs& cell : f.cells) cell.witnesses.clear();
      },
      "witnesses: yes in A, no in B");
  for (const Param& param : kParams) {
    std::string line;
    const auto change = [&](PvsFile& f) {
      const std::string before = valueText(param, f.params);
      std::visit(
          [&](const auto& field) {
            auto& value = f.params.*field.member;
            value = value == field.low ? field.high : field.low;
          },
          param.field);
      line = fmt::format("{}: {} in A, {} in B", param.name, before, valueText(param, f.params));
    };
    PvsFile pvs = examplePvs();
    change(pvs);
    expectDifferent(change, line);
  }
}

TEST_F(Diff, FindsEachDifferenceOfTheCells) {
  expectDifferent(
      [](PvsFile& f) {
        CellPvs& cell = f.cells[0];
        cell.triangles.erase(cell.triangles.begin() + 3);
        cell.witnesses.erase(cell.witnesses.begin() + 3);
      },
      "cell a: 1 triangle (7) in A only");
  expectDifferent(
      [](PvsFile& f) {
        for (uint32_t id = 10; id < 17; ++id) {
          f.cells[1].triangles.push_back(id);
          f.cells[1].witnesses.push_back({});
        }
      },
      "cell b-\xc3\xa9: 7 triangles (10, 11, 12, 13, 14, ...) in B only");
  expectDifferent([](PvsFile& f) { f.cells[0].witnesses[4].origin.y = 1.5f; },
                  "cell a: other witnesses of 1 triangle (300)");
  expectDifferent([](PvsFile& f) { f.cells[0].witnesses[0].direction.z = -0.0f; },
                  "cell a: other witnesses of 1 triangle (0)");
  expectDifferent([](PvsFile& f) { f.cells[0].witnesses[6].stage = kStageBorder; },
                  "cell a: other witnesses of 1 triangle (999)");
  expectDifferent([](PvsFile& f) { f.cells.pop_back(); }, "cell b-\xc3\xa9 is baked in A only");
  expectDifferent([](PvsFile& f) { f.cells.push_back(exampleCell(f.planned[2], {4}, true)); },
                  "cell c is baked in B only");
}

TEST_F(Diff, FindsEachDifferenceOfTheStatistics) {
  const auto expect = [&](void (*change)(CellStats&), const std::string& line) {
    expectDifferent([&](PvsFile& f) { change(f.cells[0].stats); }, "cell a: " + line);
  };
  expect([](CellStats& s) { s.random.rays = 1; }, "random rays: 1000 in A, 1 in B");
  expect([](CellStats& s) { s.border.rays = 1; }, "border rays: 2000 in A, 1 in B");
  expect([](CellStats& s) { s.reverse.rays = 1; }, "reverse rays: 30 in A, 1 in B");
  expect([](CellStats& s) { s.random.new_triangles = 9; }, "new triangles by random: 7 in A, 9 in B");
  expect([](CellStats& s) { s.border.new_triangles = 9; }, "new triangles by border: 3 in A, 9 in B");
  expect([](CellStats& s) { s.reverse.new_triangles = 9; }, "new triangles by reverse: 1 in A, 9 in B");
  expect([](CellStats& s) { s.contained_triangles = 9; }, "contained triangles: 2 in A, 9 in B");
  expect([](CellStats& s) { s.iterations = 9; }, "iterations: 4 in A, 9 in B");
  expect([](CellStats& s) { s.stop = StopReason::kConverged; }, "ended by: ray limit in A, converged in B");
  expect([](CellStats& s) { s.validation_rays = 9; }, "validation rays: 500 in A, 9 in B");
  expect([](CellStats& s) { s.missing_rays = 9; }, "missing rays: 1 in A, 9 in B");
  expect([](CellStats& s) { s.bound_rays = 9; }, "rays of the error's bound: 1048576 in A, 9 in B");
  expect([](CellStats& s) { s.bound_tests = 9; }, "tests of the error's bound: 3 in A, 9 in B");
  expect([](CellStats& s) { s.error_bound = 0.5; }, "error's bound: 0.0625 in A, 0.5 in B");
}

/// Ids mean other triangles there.
TEST_F(Diff, DoesNotCompareSetsOfOtherScenes) {
  const ProgramRun run = afterChange([](PvsFile& f) {
    f.scene_hash ^= 1;
    f.cells[0].stats.iterations = 9;
  });
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_EQ(run.output,
            "hash of the scene: 0123456789abcdef in A, 0123456789abcdee in B\n"
            "different: in 1 input, and 0 of 0 cells that both have\n");
}

TEST_F(Diff, ShowsSoManyLinesAndReportsAll) {
  const auto change = [](PvsFile& f) {
    f.params.seed = 78;
    f.cells[0].stats.iterations = 9;
    f.cells[0].stats.bound_tests = 9;
  };
  EXPECT_EQ(afterChange(change, "--lines 1").output,
            "seed: 77 in A, 78 in B\n... and 2 more differences\n"
            "different: in 1 input, and 1 of 2 cells that both have\n");
  const auto run = runSeparately("diff a.pvs b.pvs --lines 0 --report -", folder_.path());
  EXPECT_EQ(run.exit_code, 3);
  const auto document = nlohmann::json::parse(run.output);
  EXPECT_EQ(document["same"], false);
  EXPECT_EQ(document["inputs"], nlohmann::json::parse(R"([{"name":"seed","a":"77","b":"78"}])"));
  EXPECT_EQ(document["compared_cells"], 2);
  EXPECT_EQ(document["compared_triangles"], 7);
  ASSERT_EQ(document["cells"].size(), 1u);
  EXPECT_EQ(document["cells"][0]["name"], "a");
  EXPECT_EQ(document["cells"][0]["statistics"].size(), 2u);
  EXPECT_EQ(document["cells"][0]["only_a"]["count"], 0);
}

TEST_F(Diff, ReadsOlderFormatsAndSaysWhatItCannotRead) {
  writeBytes(folder_ / "old.pvs", kVersion3File);
  savePvs(loadPvs(folder_ / "old.pvs"), folder_ / "new.pvs");
  auto run = runSeparately("diff old.pvs new.pvs", folder_.path());
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(run.output.starts_with("formats: version 3 in A, 4 in B (no difference)\nthe same: 2 cells"))
      << run.output;
  auto bytes = readBytes(folder_ / "new.pvs");
  bytes[8] = 9;  // version
  writeBytes(folder_ / "newer.pvs", bytes);
  bytes[8] = 4, bytes[100] ^= 1;
  writeBytes(folder_ / "broken.pvs", bytes);
  for (const char* name : {"newer.pvs", "broken.pvs", "none.pvs"}) {
    run = runSeparately(std::string("diff old.pvs ") + name, folder_.path());
    EXPECT_EQ(run.exit_code, 1) << name;
    EXPECT_NE(run.errors.find(name), std::string::npos) << run.errors;
    EXPECT_EQ(runSeparately(std::string("diff ") + name + " old.pvs", folder_.path()).exit_code, 1) << name;
  }
}

/// Real bakes: other threads, another set, a stop in between; and another seed.
TEST_F(Diff, TellsBakesOfTheProgramApart) {
  const auto run = [&](const std::string& arguments) { return runSeparately(arguments, folder_.path()); };
  ASSERT_EQ(run("scene city -o city.glb --triangles 1k --cells cells.json").exit_code, 0);
  const std::string bake =
      "bake city.glb --cells cells.json --device cpu --n-rand 5000 --validation-rays 1000 --witnesses ";
  ASSERT_EQ(run(bake + "-o a.pvs --threads 1").exit_code, 0);
  ASSERT_EQ(run(bake + "-o b.pvs --threads 2 --set hash").exit_code, 0);
  auto same = run("diff a.pvs b.pvs");
  EXPECT_EQ(same.exit_code, 0) << same.output;
  {
    const PvsFile whole = loadPvs(folder_ / "a.pvs");
    PvsWriter part(folder_ / "c.pvs.part");
    part.begin(whole);
    for (size_t i = 0; i < 4; ++i) part.append(whole.cells[i]);
  }
  auto resumed = run(bake + "-o c.pvs");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_NE(resumed.output.find("goes on after 4 of "), std::string::npos) << resumed.output;
  same = run("diff c.pvs a.pvs");
  EXPECT_EQ(same.exit_code, 0) << same.output;
  EXPECT_TRUE(same.output.starts_with("the same: ")) << same.output;
  ASSERT_EQ(run(bake + "-o d.pvs --seed 2").exit_code, 0);
  const auto other = run("diff a.pvs d.pvs");
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_TRUE(other.output.starts_with("seed: 1 in A, 2 in B\n")) << other.output;
  EXPECT_NE(other.output.find("other witnesses of "), std::string::npos) << other.output;
}

}  // namespace
}  // namespace sightline
