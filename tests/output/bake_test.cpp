#include "core/bake/bake.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "tests/output/example_pvs.h"
#include "tests/output/system_calls.h"
#include "tests/output/version_3_file.h"

namespace sightline {
namespace {

PvsFile fiveCells() {
  PvsFile inputs = examplePvs(false);
  inputs.cells.clear();
  inputs.planned.clear();
  for (int i = 0; i < 5; ++i) inputs.planned.push_back({fmt::format("cell-{}", i), {i, 0, 0}, {1, 1, 1}, {}});
  return inputs;
}

/// Depends on the cell alone, as a real bake does.
CellPvs fakeBaker(const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
  if (progress) progress({.iteration = 1, .rays = 10});
  return exampleCell(cell, {index, index + 10, 500 + index}, false);
}

std::string problem(const PvsFile& inputs, const std::filesystem::path& file) {
  try {
    Bake bake(inputs, file);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

/// Bakes until `cells` of the bake are done, then stops as Ctrl-C does.
void bakeSome(const std::filesystem::path& file, size_t cells) {
  std::atomic<bool> stop{false};
  Bake bake(fiveCells(), file);
  BakeEvents events;
  events.cell_done = [&](uint32_t index, const CellPvs&) { stop = index + 1 >= cells; };
  events.stop = &stop;
  EXPECT_FALSE(bake.run("fake", fakeBaker, events));
}

TEST(Bake, WritesAllCellsAndRenames) {
  TemporaryFolder folder;
  Bake bake(fiveCells(), folder / "x.pvs");
  EXPECT_FALSE(bake.complete());
  std::vector<uint32_t> order;
  BakeEvents events;
  events.cell_done = [&](uint32_t index, const CellPvs&) { order.push_back(index); };
  EXPECT_TRUE(bake.run("fake", fakeBaker, events));
  EXPECT_EQ(order, (std::vector<uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.pvs.part"));
  const PvsFile pvs = loadPvs(folder / "x.pvs");
  ASSERT_EQ(pvs.cells.size(), 5u);
  EXPECT_EQ(pvs.device, "fake");
  EXPECT_EQ(pvs.cells[3].triangles, (std::vector<uint32_t>{3, 13, 503}));
}

TEST(Bake, GoesOnAfterAStopAndGivesTheSameBytes) {
  TemporaryFolder folder;
  Bake whole(fiveCells(), folder / "whole.pvs");
  EXPECT_TRUE(whole.run("fake", fakeBaker));
  for (size_t cells = 1; cells < 5; ++cells) {
    const auto file = folder / fmt::format("x{}.pvs", cells);
    bakeSome(file, cells);
    EXPECT_FALSE(std::filesystem::exists(file));
    Bake bake(fiveCells(), file);
    EXPECT_EQ(bake.resumed(), cells);
    EXPECT_TRUE(bake.run("fake", fakeBaker));
    EXPECT_EQ(readBytes(file), readBytes(folder / "whole.pvs")) << cells;
    EXPECT_FALSE(std::filesystem::exists(partFileOf(file)));
  }
}

TEST(Bake, InterruptedInsideACellKeepsTheOthers) {
  TemporaryFolder folder;
  {
    Bake bake(fiveCells(), folder / "x.pvs");
    EXPECT_FALSE(bake.run("fake", [](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
      if (index == 2) throw Interrupted{};
      return fakeBaker(cell, index, progress);
    }));
  }
  EXPECT_EQ(Bake(fiveCells(), folder / "x.pvs").resumed(), 2u);
}

/// The part file of a whole bake, as it is before the end.
std::vector<uint8_t> wholePart(const std::filesystem::path& file) {
  std::vector<uint8_t> part;
  BakeEvents events;
  events.cell_done = [&](uint32_t, const CellPvs&) { part = readBytes(partFileOf(file)); };
  EXPECT_TRUE(Bake(fiveCells(), file).run("fake", fakeBaker, events));
  return part;
}

TEST(Bake, EveryCutOfThePartFileLosesOnlyTheTornCell) {
  TemporaryFolder folder;
  const auto part = wholePart(folder / "whole.pvs"), bytes = readBytes(folder / "whole.pvs");
  size_t before = 0;
  for (size_t size = 0; size <= part.size(); size += size < 400 ? 1 : 7) {
    const auto file = folder / "x.pvs";
    writeBytes(folder / "x.pvs.part", {part.begin(), part.begin() + ptrdiff_t(size)});
    Bake bake(fiveCells(), file);
    EXPECT_GE(bake.resumed(), before);
    EXPECT_LE(bake.resumed(), before + 1);
    before = bake.resumed();
    EXPECT_TRUE(bake.run("fake", fakeBaker));
    ASSERT_EQ(readBytes(file), bytes) << "part file cut at " << size;
    std::filesystem::remove(file);
  }
  EXPECT_EQ(Bake(fiveCells(), folder / "whole.pvs").resumed(), 5u);
}

/// A kill while the finished file is put in place leaves it as the part file.
TEST(Bake, GoesOnFromAFinishedFileThatHasNotItsNameYet) {
  TemporaryFolder folder;
  wholePart(folder / "whole.pvs");
  const auto bytes = readBytes(folder / "whole.pvs");
  for (size_t size = 0; size <= bytes.size(); size += size < 400 ? 1 : 7) {
    writeBytes(folder / "x.pvs.part", {bytes.begin(), bytes.begin() + ptrdiff_t(size)});
    writeBytes(folder / "x.pvs.part.tmp", {1, 2, 3});
    Bake bake(fiveCells(), folder / "x.pvs");
    EXPECT_TRUE(bake.run("fake", fakeBaker));
    ASSERT_EQ(readBytes(folder / "x.pvs"), bytes) << "cut at " << size;
    std::filesystem::remove(folder / "x.pvs");
  }
  writeBytes(folder / "x.pvs.part", bytes);
  EXPECT_EQ(Bake(fiveCells(), folder / "x.pvs").resumed(), 5u);
}

TEST(Bake, AFailureAtTheVeryEndLosesNoCell) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "x.pvs.part.tmp");  // where the finished file should be written
  {
    Bake bake(fiveCells(), folder / "x.pvs");
    EXPECT_THROW(bake.run("fake", fakeBaker), Error);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "x.pvs"));
  std::filesystem::remove(folder / "x.pvs.part.tmp");
  Bake again(fiveCells(), folder / "x.pvs");
  EXPECT_EQ(again.resumed(), 5u);
  EXPECT_TRUE(again.run("fake", fakeBaker));
  EXPECT_EQ(loadPvs(folder / "x.pvs").cells.size(), 5u);
}

/// Times, memory and devices stand behind the rest, and say of each cell what it took itself.
TEST(Bake, EqualBakesAreEqualBytesUpToWhatTheyTook) {
  TemporaryFolder folder;
  const auto slowBaker = [](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
    CellPvs pvs = fakeBaker(cell, index, progress);
    pvs.stats.seconds = 100 + index;
    pvs.stats.random.seconds = 10 + index;
    pvs.stats.border.seconds = 20 + index;
    pvs.stats.reverse.seconds = 30 + index;
    pvs.stats.peak_device_bytes = 40 + index;
    return pvs;
  };
  EXPECT_TRUE(Bake(fiveCells(), folder / "quick.pvs").run("fake", fakeBaker));
  bakeSome(folder / "mixed.pvs", 2);
  EXPECT_TRUE(Bake(fiveCells(), folder / "mixed.pvs").run("slow device", slowBaker));
  EXPECT_NE(readBytes(folder / "mixed.pvs"), readBytes(folder / "quick.pvs"));
  const auto equal = bytesBeforeCosts(folder / "quick.pvs");
  EXPECT_LT(equal.size(), readBytes(folder / "quick.pvs").size());
  EXPECT_EQ(bytesBeforeCosts(folder / "mixed.pvs"), equal);
  const PvsFile mixed = loadPvs(folder / "mixed.pvs");
  EXPECT_EQ(mixed.device, "fake");
  EXPECT_EQ(mixed.cells[1].device, "fake");
  EXPECT_EQ(mixed.cells[1].stats.seconds, 1.5);
  EXPECT_EQ(mixed.cells[2].device, "slow device");
  EXPECT_EQ(mixed.cells[2].stats.seconds, 102);
  EXPECT_EQ(mixed.cells[4].stats.reverse.seconds, 34);
  EXPECT_EQ(mixed.cells[4].stats.peak_device_bytes, 44u);
}

/// Its times, too, are there before the bake is.
TEST(Bake, AnInterruptedOneHasItsTimes) {
  TemporaryFolder folder;
  bakeSome(folder / "x.pvs", 2);
  const PartialPvs left = loadPartialPvs(folder / "x.pvs.part");
  ASSERT_EQ(left.pvs.cells.size(), 2u);
  EXPECT_EQ(left.problem, "");
  EXPECT_EQ(left.pvs.cells[1].stats.seconds, 1.5);
  EXPECT_EQ(left.pvs.cells[1].device, "fake");
}

TEST(Bake, RefusesToGoOnWithAnotherAlgorithmOrIntersector) {
  TemporaryFolder folder;
  EXPECT_TRUE(Bake(fiveCells(), folder / "done.pvs").run("fake", fakeBaker));
  bakeSome(folder / "part.pvs", 2);
  const auto expectRefused = [&](auto change, const std::string& part) {
    PvsFile other = fiveCells();
    change(other);
    for (const char* name : {"done.pvs", "part.pvs"}) {
      const std::string line = problem(other, folder / name);
      EXPECT_NE(line.find(part), std::string::npos) << line;
      EXPECT_NE(line.find("choose another -o, or --overwrite it"), std::string::npos) << line;
    }
  };
  expectRefused([](PvsFile& f) { f.algorithm = 8; }, "revision of the algorithm (7 there, 8 now)");
  expectRefused([](PvsFile& f) { f.intersector = ""; },
                "intersection test (that of GPU, driver 5 there, that of cpu and opencl now)");
  expectRefused([](PvsFile& f) { f.intersector = "GPU, driver 6"; },
                "intersection test (that of GPU, driver 5 there, that of GPU, driver 6 now)");
  EXPECT_EQ(Bake(fiveCells(), folder / "part.pvs").resumed(), 2u);
}

TEST(Bake, RefusesToGoOnWithAFileOfAnOlderFormat) {
  TemporaryFolder folder;
  writeBytes(folder / "x.pvs.part", kVersion3File);
  PvsFile same = examplePvs();
  same.intersector = "";
  EXPECT_NE(problem(same, folder / "x.pvs").find("version of the format (3 there, 4 now)"),
            std::string::npos);
  EXPECT_EQ(readBytes(folder / "x.pvs.part"), kVersion3File);
}

TEST(Bake, OverwritesWhatIsDamagedButNotWhatItCannotRead) {
  TemporaryFolder folder;
  bakeSome(folder / "x.pvs", 2);
  const auto part = readBytes(folder / "x.pvs.part");
  SystemCalls::reads_fail = true;
  std::string line;
  try {
    Bake(fiveCells(), folder / "x.pvs", true);
  } catch (const Error& error) {
    line = error.what();
  }
  SystemCalls::reads_fail = false;
  EXPECT_NE(line.find("x.pvs.part: cannot read"), std::string::npos) << line;
  EXPECT_EQ(readBytes(folder / "x.pvs.part"), part);
  writeBytes(folder / "x.pvs.part", std::vector<uint8_t>(100, 7));
  EXPECT_EQ(Bake(fiveCells(), folder / "x.pvs", true).resumed(), 0u);
}

TEST(Bake, APartFileOfAnotherKindIsNotReplaced) {
  TemporaryFolder folder;
  writeBytes(folder / "x.pvs.part", {'a', 'b', 'c'});
  EXPECT_NE(problem(fiveCells(), folder / "x.pvs").find("not a .pvs file"), std::string::npos);
  EXPECT_EQ(readBytes(folder / "x.pvs.part").size(), 3u);
}

TEST(Bake, RefusesCellsThatNoReaderWouldTake) {
  TemporaryFolder folder;
  PvsFile inputs = fiveCells();
  inputs.planned[3].size = {0, 0, 1};
  EXPECT_EQ(problem(inputs, folder / "x.pvs"),
            "cells[3].size: the cell has no area; at most one extent may be 0");
}

/// As verify writes of a bake that was stopped: what was improved in it is not to be had again.
TEST(Bake, AnUnfinishedFileIsReplacedOnlyWhenAsked) {
  TemporaryFolder folder;
  PvsFile some = fiveCells();
  some.cells.push_back(fakeBaker(some.planned[0], 0, {}));
  savePvs(some, folder / "x.pvs");
  EXPECT_NE(problem(fiveCells(), folder / "x.pvs").find("holds 1 of 5 cells"), std::string::npos);
  EXPECT_TRUE(Bake(fiveCells(), folder / "x.pvs", true).run("fake", fakeBaker));
  EXPECT_EQ(loadPvs(folder / "x.pvs").cells.size(), 5u);
}

/// Whoever uses the library catches std::exception.
TEST(Bake, WhatItThrowsIsAnException) {
  EXPECT_TRUE((std::is_base_of_v<std::exception, Interrupted>));
  EXPECT_TRUE((std::is_base_of_v<std::exception, BadPvs>));
}

TEST(Bake, KilledAtAnyMomentGoesOn) {
  TemporaryFolder folder;
  Bake whole(fiveCells(), folder / "whole.pvs");
  EXPECT_TRUE(whole.run("fake", fakeBaker));
  for (int delay_us : {0, 500, 2000, 5000, 12000, 20000}) {
    const auto file = folder / fmt::format("k{}.pvs", delay_us);
    const pid_t child = ::fork();
    if (child == 0) {
      Bake bake(fiveCells(), file);
      bake.run("fake", [](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
        ::usleep(3000);
        return fakeBaker(cell, index, progress);
      });
      ::_exit(0);
    }
    ::usleep(useconds_t(delay_us));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    Bake bake(fiveCells(), file);
    EXPECT_TRUE(bake.run("fake", fakeBaker));
    EXPECT_EQ(readBytes(file), readBytes(folder / "whole.pvs")) << delay_us;
  }
}

TEST(Bake, ACompleteFileIsLeftAlone) {
  TemporaryFolder folder;
  EXPECT_TRUE(Bake(fiveCells(), folder / "x.pvs").run("fake", fakeBaker));
  const auto bytes = readBytes(folder / "x.pvs");
  Bake again(fiveCells(), folder / "x.pvs");
  EXPECT_TRUE(again.complete());
  EXPECT_EQ(again.resumed(), 5u);
  EXPECT_TRUE(again.run("other", [](const ViewCell&, uint32_t, const ProgressCallback&) -> CellPvs {
    throw Error("must not bake");
  }));
  EXPECT_EQ(readBytes(folder / "x.pvs"), bytes);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.pvs.part"));
}

TEST(Bake, NamesEveryDifferenceOfTheInputs) {
  const PvsFile inputs = fiveCells();
  EXPECT_TRUE(inputDifferences(inputs, inputs).empty());
  const auto difference = [&](auto change) {
    PvsFile other = inputs;
    change(other);
    const auto list = inputDifferences(inputs, other);
    return list.size() == 1 ? list[0] : fmt::format("{} differences", list.size());
  };
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.version = 3; }), "version of the format"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.algorithm = 8; }), "revision of the algorithm"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.intersector = "other"; }), "intersection test"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.scene_hash ^= 1; }), "scene"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.planned.pop_back(); }), "number of cells (5 there, 4"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.planned[2].size.x = 9; }), "cell-2"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.planned[2].name = "z"; }), "z now"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.has_witnesses = true; }), "witnesses"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.method = Method::kGvs; }),
                       "method (random there, gvs now)"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.raster_resolution = 7; }), "raster_resolution"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.target_error = 0.5; }), "target_error"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.abs_spacing = 0.5f; }), "abs_spacing"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.reverse_stride = 7; }), "reverse_stride"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.order = Order::kYield; }),
                       "order (queue there, yield now)"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.n_rand = 7; }), "n_rand (4321 there, 7 now)"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.n_abs_edge = 7; }), "n_abs_edge"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.n_rs_edge = 7; }), "n_rs_edge"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.n_rs_area = 7; }), "n_rs_area"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.delta_abs = 7; }), "delta_abs "));
  EXPECT_TRUE(
      contains(difference([](PvsFile& f) { f.params.delta_abs_relative = 7; }), "delta_abs_relative"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.delta_rs = 7; }), "delta_rs "));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.delta_rs_relative = 7; }), "delta_rs_relative"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.threshold = 7; }), "threshold"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.quiet_iterations = 7; }), "quiet_iterations"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.max_rays = 7; }), "max_rays"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.max_seconds = 7; }), "max_seconds"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.batch_rays = 7; }), "batch_rays"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.validation_rays = 7; }), "validation_rays"));
  EXPECT_TRUE(contains(difference([](PvsFile& f) { f.params.seed = 7; }), "seed"));
  EXPECT_TRUE(inputDifferences(inputs,
                               [&] {
                                 PvsFile other = inputs;
                                 other.device = "another";
                                 return other;
                               }())
                  .empty());
}

TEST(Bake, RefusesOtherInputsAndOverwritesWhenAsked) {
  TemporaryFolder folder;
  EXPECT_TRUE(Bake(fiveCells(), folder / "done.pvs").run("fake", fakeBaker));
  bakeSome(folder / "part.pvs", 2);
  PvsFile other = fiveCells();
  other.params.seed = 99;
  for (const char* name : {"done.pvs", "part.pvs"}) {
    EXPECT_NE(problem(other, folder / name).find("seed (77 there, 99 now)"), std::string::npos) << name;
    EXPECT_NE(problem(other, folder / name).find("--overwrite"), std::string::npos) << name;
    EXPECT_TRUE(Bake(other, folder / name, true).run("fake", fakeBaker));
    EXPECT_EQ(loadPvs(folder / name).params.seed, 99u) << name;
  }
}

/// Nothing is lost with it.
TEST(Bake, APartFileWithoutCellsIsInNobodysWay) {
  TemporaryFolder folder;
  { PvsWriter(folder / "x.pvs.part").begin(fiveCells()); }
  ASSERT_GT(std::filesystem::file_size(folder / "x.pvs.part"), 0u);
  PvsFile other = fiveCells();
  other.params.seed = 99;
  Bake bake(other, folder / "x.pvs");
  EXPECT_EQ(bake.resumed(), 0u);
  EXPECT_TRUE(bake.run("fake", fakeBaker));
  EXPECT_EQ(loadPvs(folder / "x.pvs").params.seed, 99u);
}

TEST(Bake, AnInterruptedOverwriteGoesOn) {
  TemporaryFolder folder;
  EXPECT_TRUE(Bake(fiveCells(), folder / "x.pvs").run("fake", fakeBaker));
  PvsFile other = fiveCells();
  other.params.seed = 99;
  {
    Bake bake(other, folder / "x.pvs", true);
    std::atomic<bool> stop{false};
    BakeEvents events;
    events.cell_done = [&](uint32_t, const CellPvs&) { stop = true; };
    events.stop = &stop;
    EXPECT_FALSE(bake.run("fake", fakeBaker, events));
  }
  EXPECT_EQ(loadPvs(folder / "x.pvs").params.seed, 77u);
  EXPECT_EQ(Bake(other, folder / "x.pvs", true).resumed(), 1u);
}

TEST(Bake, RefusesADamagedFileAndASecondWriter) {
  TemporaryFolder folder;
  writeBytes(folder / "x.pvs", {1, 2, 3});
  EXPECT_NE(problem(fiveCells(), folder / "x.pvs"), "");
  writeBytes(folder / "y.pvs.part", std::vector<uint8_t>(100, 7));
  const std::string in_the_way = problem(fiveCells(), folder / "y.pvs");
  EXPECT_NE(in_the_way.find("y.pvs.part"), std::string::npos) << in_the_way;
  EXPECT_NE(in_the_way.find("--overwrite"), std::string::npos) << in_the_way;
  Bake first(fiveCells(), folder / "z.pvs");
  EXPECT_NE(problem(fiveCells(), folder / "z.pvs").find("another bake"), std::string::npos);
  EXPECT_NE(problem(fiveCells(), folder.path()), "");
  EXPECT_NE(problem(fiveCells(), folder / "none/x.pvs"), "");
}

TEST(Bake, LeavesNoPartFileWhenNothingWasBegun) {
  TemporaryFolder folder;
  { Bake bake(fiveCells(), folder / "x.pvs"); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Bake, AThousandCellsCostLittle) {
  TemporaryFolder folder;
  PvsFile inputs = fiveCells();
  inputs.triangle_count = 100000;
  inputs.planned.clear();
  for (int i = 0; i < 1000; ++i) inputs.planned.push_back({std::to_string(i), {i, 0, 0}, {1, 1, 1}, {}});
  std::vector<uint32_t> ids(20000);
  for (size_t i = 0; i < ids.size(); ++i) ids[i] = uint32_t(i * 3);
  const auto baker = [&](const ViewCell& cell, uint32_t, const ProgressCallback&) {
    return exampleCell(cell, ids, false);
  };
  EXPECT_TRUE(Bake(inputs, folder / "x.pvs").run("fake", baker));
  // A set is written once, not once more for each later cell.
  EXPECT_LT(std::filesystem::file_size(folder / "x.pvs"), 1000u * 2000u);
  EXPECT_TRUE(Bake(inputs, folder / "x.pvs").complete());
}

}  // namespace
}  // namespace sightline
