#include <fmt/core.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/device/device.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/algorithm_revision.h"
#include "core/pvs/pvs_writer.h"
#include "tests/cli/run_program.h"
#include "tests/output/example_pvs.h"
#include "tests/scene/files.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::readText;
using test::Running;
using test::runProgram;

/// A folder with a scene of a few hundred triangles (a floor with boxes on it) and cells above the floor.
class Workplace {
 public:
  explicit Workplace(int cells = 3) {
    std::ofstream scene(folder_ / "blocks.obj");
    int vertices = 0;
    for (int x = 0; x < 6; ++x) {
      for (int z = 0; z < 6; ++z) writeBox(scene, vertices, 4.0 * x, 4.0 * z, 1 + (x * 5 + z * 3) % 4);
    }
    std::ofstream out(folder_ / "cells.json");
    out << "{\"cells\":[";
    for (int i = 0; i < cells; ++i) {
      out << fmt::format("{}{{\"name\":\"cell-{}\",\"center\":[{},0.5,10],\"size\":[0.5,0.5,0.5]}}",
                         i == 0 ? "" : ",", i, 3 + 0.01 * i);
    }
    out << "]}";
  }

  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }
  const std::filesystem::path& path() const { return folder_.path(); }

  /// Arguments of a quick bake to `out`.
  std::string bake(const std::string& out, const std::string& more = "",
                   const std::string& device = "cpu") const {
    return fmt::format(
        "bake {} --cells {} -o {} --device {} --n-rand 20000 --n-abs-edge 4 --n-rs-edge 4 --n-rs-area 4 "
        "--validation-rays 20000 {}",
        *this / "blocks.obj", *this / "cells.json", *this / out, device, more);
  }

 private:
  static void writeBox(std::ofstream& out, int& vertices, double x, double z, double height) {
    out << fmt::format("o box_{}_{}\n", int(x), int(z));
    for (int corner = 0; corner < 8; ++corner) {
      out << fmt::format("v {} {} {}\n", x + (corner & 1 ? 2 : 0), corner & 2 ? height : 0.0,
                         z + (corner & 4 ? 2 : 0));
    }
    for (const auto& f :
         {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
      out << fmt::format("f {} {} {} {}\n", vertices + f[0], vertices + f[1], vertices + f[2],
                         vertices + f[3]);
    }
    vertices += 8;
  }

  TemporaryFolder folder_;
};

/// Both files hold the same bytes but for times, memory and device.
void expectSameBake(const std::string& a, const std::string& b) {
  EXPECT_EQ(bytesBeforeCosts(a), bytesBeforeCosts(b));
}

bool contains(const ProgramRun& run, const std::string& part) {
  return run.output.find(part) != std::string::npos;
}

/// Waits until the part file holds at least so many cells.
void waitForCells(const std::string& part, size_t cells) {
  for (int tries = 0; tries < 2000; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (std::filesystem::exists(part) && loadPartialPvs(part).pvs.cells.size() >= cells) return;
  }
  FAIL() << part << " never held " << cells << " cells";
}

TEST(BakeCommand, BakesShowsATableAndIsRepeatable) {
  const Workplace place;
  const ProgramRun run = runProgram(place.bake("x.pvs"));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(contains(run, "432 triangles, 36 objects; 3 cells")) << run.output;
  EXPECT_TRUE(contains(run, "cell-2 3/3  done")) << run.output;
  EXPECT_TRUE(contains(run, "missing rays (95 %)")) << run.output;
  EXPECT_EQ(run.output.find('\r'), std::string::npos);
  ASSERT_EQ(loadPvs(place / "x.pvs").cells.size(), 3u);
  EXPECT_GT(loadPvs(place / "x.pvs").cells[0].triangles.size(), 50u);
  ASSERT_EQ(runProgram(place.bake("y.pvs", "--threads 1")).exit_code, 0);
  expectSameBake(place / "x.pvs", place / "y.pvs");
}

struct OddCell {
  std::string name, center, size;
};

/// Replaces the cells of the workplace.
void writeCells(const Workplace& place, const std::vector<OddCell>& cells) {
  std::ofstream out(place / "cells.json");
  out << "{\"cells\":[";
  for (size_t i = 0; i < cells.size(); ++i) {
    out << (i == 0 ? "" : ",")
        << fmt::format(R"({{"name":"{}","center":[{}],"size":[{}]}})", cells[i].name, cells[i].center,
                       cells[i].size);
  }
  out << "]}";
}

/// Blocks of 2 x 2 stand at 0, 4, 8, ... with gaps of 2 between them.
const std::vector<OddCell> kOddCells = {{"good", "3,0.5,10", "0.5,0.5,0.5"},
                                        {"cut", "2,0.5,1", "0.5,0.5,0.5"},
                                        {"inside", "1,0.5,1", "0.1,0.1,0.1"},
                                        {"away", "300,0.5,1", "0.5,0.5,0.5"},
                                        {"huge", "11,55,11", "90,1,1"}};

TEST(BakeCommand, WarnsOfCellsThatAreHardlyMeant) {
  const Workplace place;
  writeCells(place, kOddCells);
  const std::string bake =
      place.bake("x.pvs", "--report " + (place / "r.json") + " --html " + (place / "r.html"));
  for (const bool complete : {false, true}) {  // again: without a device
    const ProgramRun run = runProgram(bake);
    ASSERT_EQ(run.exit_code, 0) << run.output;
    EXPECT_EQ(contains(run, "already complete"), complete);
    EXPECT_FALSE(contains(run, "warning: good")) << run.output;
    EXPECT_TRUE(contains(run, "warning: cut cuts or touches ")) << run.output;
    EXPECT_TRUE(contains(run, "warning: inside lies inside something solid")) << run.output;
    EXPECT_TRUE(contains(run, "warning: away lies outside the scene, ")) << run.output;
    EXPECT_TRUE(contains(run, "warning: huge is 90 long, ")) << run.output;
    const size_t table = run.output.find("missing rays (95 %)");
    ASSERT_NE(table, std::string::npos);
    EXPECT_NE(run.output.find("warning: in solid", table), std::string::npos) << run.output;

    const auto cells = nlohmann::json::parse(readText(place / "r.json"))["cells"];
    ASSERT_EQ(cells.size(), 5u);
    const char* verdicts[] = {"", "meets triangles", "in solid", "outside", "too large"};
    EXPECT_TRUE(cells[0]["warnings"].empty()) << cells[0];
    for (size_t i = 1; i < 5; ++i) {
      ASSERT_GE(cells[i]["warnings"].size(), 1u) << i;
      EXPECT_EQ(cells[i]["warnings"][0]["verdict"], verdicts[i]);
    }
    EXPECT_GE(cells[1]["warnings"][0]["met_triangles"].get<int>(), 2);
    const std::string page = readText(place / "r.html");
    EXPECT_NE(page.find("<th scope=\"col\">warnings</th>"), std::string::npos);
    EXPECT_NE(page.find("lies inside something solid"), std::string::npos);
  }
}

TEST(BakeCommand, StrictCellsNamesThemAllBeforeTheBake) {
  const Workplace place;
  EXPECT_EQ(runProgram(place.bake("y.pvs", "--strict-cells")).exit_code, 0) << "good cells";
  writeCells(place, kOddCells);
  const ProgramRun run = runProgram(place.bake("x.pvs", "--strict-cells"));
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_TRUE(contains(run, "sightline: --strict-cells: 4 cells cannot be taken: cut cuts or touches "))
      << run.output;
  for (const char* cell : {"; inside lies", "; away lies", "; huge is"})
    EXPECT_TRUE(contains(run, cell)) << run.output;
  EXPECT_FALSE(contains(run, "good 1/5")) << run.output;
  EXPECT_FALSE(std::filesystem::exists(place / "x.pvs"));
  EXPECT_FALSE(std::filesystem::exists(place / "x.pvs.part"));
  writeCells(place, {{"inside", "1,0.5,1", "0.1,0.1,0.1"}});
  EXPECT_EQ(runProgram(place.bake("z.pvs", "--strict-cells --free-side any")).exit_code, 0);
}

TEST(BakeCommand, OfManyCellsTheFirstFewAreWarnedOf) {
  const Workplace place;
  std::vector<OddCell> cells;
  for (int i = 0; i < 25; ++i) cells.push_back({fmt::format("cell-{}", i), "300,1,1", "0.5,0.5,0.5"});
  writeCells(place, cells);
  const ProgramRun run = runProgram(place.bake("x.pvs"));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(contains(run, "warning: cell-9 ")) << run.output;
  EXPECT_FALSE(contains(run, "warning: cell-10 ")) << run.output;
  EXPECT_TRUE(contains(run, "warning: 15 cells more")) << run.output;
}

TEST(BakeCommand, WarnsOfCellsThatSeeNothingOrEverything) {
  const Workplace place;
  std::ofstream(place / "blocks.obj") << "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n";
  // Flat cells look along +z: the first away from the triangle, the second towards it.
  writeCells(place, {{"before", "1,1,1", "1,1,0"}, {"behind", "1,1,-1", "1,1,0"}});
  ProgramRun run = runProgram(place.bake("x.pvs", "--free-side any"));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(contains(run, "warning: before sees nothing\n")) << run.output;
  EXPECT_TRUE(contains(run, "warning: behind sees everything: every triangle")) << run.output;
  run = runProgram(place.bake("x.pvs", "--free-side any --strict-cells"));
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_TRUE(contains(run, "before sees nothing; behind sees everything")) << run.output;
  EXPECT_TRUE(std::filesystem::exists(place / "x.pvs")) << "what is baked is kept";
}

TEST(BakeCommand, KeepsWitnessesOnlyWhenAsked) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("with.pvs", "--witnesses")).exit_code, 0);
  ASSERT_EQ(runProgram(place.bake("without.pvs")).exit_code, 0);
  const PvsFile with = loadPvs(place / "with.pvs"), without = loadPvs(place / "without.pvs");
  EXPECT_EQ(with.cells[0].triangles, without.cells[0].triangles);
  EXPECT_EQ(with.cells[0].witnesses.size(), with.cells[0].triangles.size());
  EXPECT_TRUE(without.cells[0].witnesses.empty());
}

/// A complete bake is left as it is where its device, whose intersection test is that of all, is not there.
TEST(BakeCommand, ACompleteBakeNeedsNoDevice) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  const ProgramRun again = runProgram(place.bake("x.pvs", "", "opencl"), "OCL_ICD_VENDORS=/nonexistent");
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_TRUE(contains(again, "already complete")) << again.output;
}

TEST(BakeCommand, AgainIsAlreadyComplete) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  const auto bytes = readBytes(place / "x.pvs");
  const ProgramRun again = runProgram(place.bake("x.pvs", "--report " + (place / "r.json")));
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_TRUE(contains(again, "already complete")) << again.output;
  EXPECT_EQ(readBytes(place / "x.pvs"), bytes);
  EXPECT_EQ(nlohmann::json::parse(readText(place / "r.json"))["complete"], true);
}

TEST(BakeCommand, OtherInputsAreAnErrorUntilOverwritten) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  const ProgramRun other = runProgram(place.bake("x.pvs", "--seed 2 --threshold 3"));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_TRUE(contains(other, "threshold (10 there, 3 now), seed (1 there, 2 now)")) << other.output;
  EXPECT_TRUE(contains(other, "--overwrite")) << other.output;
  EXPECT_EQ(runProgram(place.bake("x.pvs", "--seed 2 --overwrite")).exit_code, 0);
  EXPECT_EQ(loadPvs(place / "x.pvs").params.seed, 2u);
}

TEST(BakeCommand, GoesOnAfterKill) {
  const Workplace place(8);
  ASSERT_EQ(runProgram(place.bake("whole.pvs")).exit_code, 0);
  for (size_t cells : {0u, 1u, 4u}) {
    const std::string name = fmt::format("killed-{}.pvs", cells);
    Running bake(place.bake(name), place / "log");
    waitForCells(place / (name + ".part"), cells);
    bake.send(SIGKILL);
    if (bake.wait() != -SIGKILL) continue;  // it was faster than we
    EXPECT_FALSE(std::filesystem::exists(place / name));
    const ProgramRun again = runProgram(place.bake(name));
    EXPECT_EQ(again.exit_code, 0) << again.output;
    EXPECT_TRUE(cells == 0 || contains(again, "goes on after")) << again.output;
    expectSameBake(place / name, place / "whole.pvs");
  }
}

TEST(BakeCommand, CtrlCAndTermKeepWhatIsFinished) {
  const Workplace place(100);
  for (int signal : {SIGINT, SIGTERM}) {
    const std::string name = fmt::format("stopped-{}.pvs", signal);
    Running bake(place.bake(name, "--report " + (place / "r.json")), place / "log");
    waitForCells(place / (name + ".part"), 2);
    bake.send(signal);
    EXPECT_EQ(bake.wait(), 128 + signal) << readText(place / "log");
    const std::string log = readText(place / "log");
    EXPECT_NE(log.find("of 100 cells are kept in"), std::string::npos) << log;
    EXPECT_NE(log.find("the same command goes on"), std::string::npos) << log;
    const auto report = nlohmann::json::parse(readText(place / "r.json"));
    EXPECT_EQ(report["complete"], false);
    EXPECT_GE(report["cells"].size(), 2u);
    EXPECT_GE(loadPartialPvs(place / (name + ".part")).pvs.cells.size(), 2u);
    const ProgramRun info = runProgram("info " + (place / (name + ".part")));
    EXPECT_EQ(info.exit_code, 0) << info.output;
    EXPECT_TRUE(contains(info, "of 100 baked")) << info.output;
  }
}

/// The first signal waits for the launch in work; whoever cannot wait sends another.
TEST(BakeCommand, ASecondCtrlCEndsItAtOnceAndLosesNoFinishedCell) {
  const Workplace place(4);
  ASSERT_EQ(runProgram(place.bake("whole.pvs")).exit_code, 0);
  Running bake(place.bake("x.pvs"), place / "log");
  waitForCells(place / "x.pvs.part", 1);
  bake.send(SIGSTOP);  // so that both signals come before it can end in order
  bake.send(SIGINT);
  bake.send(SIGCONT);
  bake.send(SIGINT);
  const int result = bake.wait();
  EXPECT_TRUE(result == 130 || result == -SIGINT) << result;
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  expectSameBake(place / "x.pvs", place / "whole.pvs");
}

/// A bake that another device began, and that was stopped on the way, is that bake.
TEST(BakeCommand, GoesOnOnAnotherExactDeviceToTheSameBytes) {
  const Workplace place(8);
  ASSERT_EQ(runProgram(place.bake("whole.pvs", "--witnesses --threads 1")).exit_code, 0);
  Running bake(place.bake("x.pvs", "--witnesses --threads 2"), place / "log");
  waitForCells(place / "x.pvs.part", 1);
  bake.send(SIGINT);
  ASSERT_EQ(bake.wait(), 130) << readText(place / "log");
  const ProgramRun again = runProgram(place.bake("x.pvs", "--witnesses", "opencl"));
  ASSERT_EQ(again.exit_code, 0) << again.output;
  expectSameBake(place / "x.pvs", place / "whole.pvs");
  const PvsFile pvs = loadPvs(place / "x.pvs");
  EXPECT_TRUE(pvs.device.starts_with("cpu, ")) << pvs.device;
  EXPECT_EQ(pvs.cells.front().device, pvs.device);
  EXPECT_TRUE(pvs.cells.back().device.starts_with("opencl:")) << pvs.cells.back().device;
  for (const CellPvs& cell : pvs.cells) EXPECT_GT(cell.stats.seconds, 0) << cell.cell.name;
}

/// A driver's own intersection test may decide otherwise: one file holds one test's sets.
TEST(BakeCommand, DoesNotGoOnOnADeviceWithAnotherIntersectionTest) {
  SL_SKIP_WITHOUT_VULKAN();
  const Workplace place(4);
  ASSERT_EQ(runProgram(place.bake("cpu.pvs")).exit_code, 0);
  const ProgramRun other = runProgram(place.bake("cpu.pvs", "", "vulkan"));
  EXPECT_EQ(other.exit_code, 1) << other.output;
  EXPECT_TRUE(contains(other, "intersection test (that of cpu and opencl there, that of ")) << other.output;
  EXPECT_TRUE(contains(other, "--overwrite")) << other.output;
  const ProgramRun first = runProgram(place.bake("vulkan.pvs", "", "vulkan"));
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_EQ(loadPvs(place / "vulkan.pvs").intersector, intersectorOf(requireDevice("vulkan")));
  EXPECT_TRUE(contains(runProgram("info " + (place / "vulkan.pvs")), "intersection test of "));
  const ProgramRun again = runProgram(place.bake("vulkan.pvs", "", "vulkan"));
  EXPECT_TRUE(contains(again, "already complete")) << again.output;
  const ProgramRun back = runProgram(place.bake("vulkan.pvs"));
  EXPECT_EQ(back.exit_code, 1) << back.output;
  EXPECT_TRUE(contains(back, "that of cpu and opencl now)")) << back.output;
}

TEST(BakeCommand, DoesNotGoOnAfterAnotherRevisionOfTheAlgorithm) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  PvsFile older = loadPvs(place / "x.pvs");
  EXPECT_EQ(older.algorithm, kAlgorithmRevision);
  EXPECT_EQ(older.intersector, "");
  older.algorithm = 1;
  savePvs(older, place / "x.pvs");
  const ProgramRun run = runProgram(place.bake("x.pvs"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(contains(run, "revision of the algorithm (1 there, ")) << run.output;
  EXPECT_TRUE(contains(run, "--overwrite")) << run.output;
}

TEST(BakeCommand, AnOutputThatFailsCostsNoOther) {
  const Workplace place;
  const std::string outputs = fmt::format("--report - --html {} --csv {}", place / "x.html", place / "x.csv");
  const std::string command =
      fmt::format("{} {} > /dev/full 2> {}", SL_PROGRAM, place.bake("x.pvs", outputs), place / "log");
  EXPECT_NE(std::system(command.c_str()), 0);
  for (const char* name : {"x.pvs", "x.html", "x.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(place / name)) << name;
  }
}

TEST(BakeCommand, DevicesSayWhetherTheyAreExact) {
  for (const DeviceInfo& device : listDevices()) {
    if (!device.unusable.empty()) continue;
    const bool ours = device.id == "cpu" || device.id.starts_with("opencl");
    EXPECT_EQ(device.exact, ours) << device.id;
    EXPECT_EQ(intersectorOf(device), ours ? "" : device.name + ", " + device.driver);
  }
}

TEST(BakeCommand, SameOnAnyNumberOfPoclThreads) {
  const Workplace place(2);
  ASSERT_EQ(runProgram(place.bake("cpu.pvs", "--witnesses")).exit_code, 0);
  for (const char* threads : {"1", "2", "7"}) {
    ASSERT_EQ(::setenv("POCL_MAX_PTHREAD_COUNT", threads, 1), 0);
    const std::string out = fmt::format("opencl-{}.pvs", threads);
    const ProgramRun run = runProgram(place.bake(out, "--witnesses", "opencl"));
    ::unsetenv("POCL_MAX_PTHREAD_COUNT");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    expectSameBake(place / out, place / "cpu.pvs");
  }
}

TEST(BakeCommand, SaysWhatADamagedPartFileLost) {
  const Workplace place(4);
  ASSERT_EQ(runProgram(place.bake("whole.pvs")).exit_code, 0);
  size_t two_cells = 0;
  {
    const PvsFile whole = loadPvs(place / "whole.pvs");
    PvsWriter part(place / "x.pvs.part");
    part.begin(whole);
    for (size_t i = 0; i < whole.cells.size(); ++i) {
      if (i == 2) two_cells = std::filesystem::file_size(place / "x.pvs.part");
      part.append(whole.cells[i]);
    }
  }
  std::vector<uint8_t> bytes = readBytes(place / "x.pvs.part");
  bytes[two_cells + 30] ^= 1;
  writeBytes(place / "x.pvs.part", bytes);
  const ProgramRun run = runProgram(place.bake("x.pvs"));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(contains(run, "x.pvs.part: cut off or damaged after 2 whole cells")) << run.output;
  expectSameBake(place / "x.pvs", place / "whole.pvs");
}

TEST(BakeCommand, StaysWithinItsMemoryBudgetOrSaysWhatItNeeds) {
  const Workplace place(1);
  for (const char* device : {"cpu", "opencl"}) {
    const ProgramRun run = runProgram(place.bake("x.pvs", "--memory-budget 1000", device));
    EXPECT_EQ(run.exit_code, 1) << run.output;
    EXPECT_TRUE(contains(run, "--memory-budget")) << run.output;
    EXPECT_FALSE(std::filesystem::exists(place / "x.pvs")) << device;
  }
  for (const char* budget : {"-5", "-5GB", "GB", "5.5", "1e400"}) {
    const ProgramRun run = runProgram(place.bake("x.pvs", std::string("--memory-budget=") + budget));
    EXPECT_EQ(run.exit_code, 2) << budget;
    EXPECT_TRUE(contains(run, "is not a whole number of bytes, such as")) << run.output;
  }
}

TEST(BakeCommand, ReportIsComplete) {
  const Workplace place(2);
  const ProgramRun run = runProgram(place.bake("x.pvs", "--set hash --report " + (place / "r.json")));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto report = nlohmann::json::parse(readText(place / "r.json"));
  EXPECT_EQ(report["complete"], true);
  EXPECT_EQ(report["device"]["id"], "cpu");
  EXPECT_EQ(report["features"]["set"], "hash");
  EXPECT_EQ(report["scene"]["triangles"], 432);
  EXPECT_EQ(report["parameters"]["n_rand"], 20000);
  EXPECT_GT(report["tree"]["bytes_per_triangle"].get<double>(), 10);
  EXPECT_GT(report["peak_process_bytes"].get<uint64_t>(), 1u << 20);
  ASSERT_EQ(report["cells"].size(), 2u);
  const PvsFile pvs = loadPvs(place / "x.pvs");
  EXPECT_EQ(report["cells"][1]["pvs_size"], pvs.cells[1].triangles.size());
  EXPECT_EQ(report["cells"][1]["stages"]["random"]["rays"], pvs.cells[1].stats.random.rays);
  EXPECT_GT(report["cells"][1]["peak_device_bytes"].get<uint64_t>(), 0u);
  EXPECT_EQ(report["cells"][1]["validation_rays"], 20000);
}

TEST(BakeCommand, MethodsAreChosenByNameAndKeptInTheFile) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs", "--method random --report " + (place / "r.json"))).exit_code, 0);
  const auto report = nlohmann::json::parse(readText(place / "r.json"));
  EXPECT_EQ(report["parameters"]["method"], "random");
  EXPECT_EQ(report["cells"][0]["stages"]["border"]["rays"], 0);
  EXPECT_TRUE(contains(runProgram("info " + (place / "x.pvs")), "random"));
  const ProgramRun other = runProgram(place.bake("x.pvs"));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_TRUE(contains(other, "method (random there, gvs++ now)")) << other.output;
  const ProgramRun unknown = runProgram(place.bake("y.pvs", "--method best"));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_TRUE(contains(unknown, "best")) << unknown.output;
}

TEST(BakeCommand, NaiveGivesTheSetOfGvspp) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  ASSERT_EQ(runProgram(place.bake("y.pvs", "--method naive")).exit_code, 0);
  EXPECT_EQ(loadPvs(place / "x.pvs").cells[0].triangles, loadPvs(place / "y.pvs").cells[0].triangles);
  ASSERT_EQ(runProgram(place.bake("z.pvs", "--method gvs")).exit_code, 0);
  EXPECT_GT(loadPvs(place / "z.pvs").cells[0].stats.border.rays, 0u);
}

/// What is given beside --thesis wins, wherever it stands.
TEST(BakeCommand, TheThesisParametersGiveWayToOthers) {
  const Workplace place(1);
  for (const char* more : {"--thesis --delta-abs 0.25", "--delta-abs 0.25 --thesis"}) {
    const ProgramRun run = runProgram(place.bake("x.pvs", std::string(more) + " --overwrite"));
    ASSERT_EQ(run.exit_code, 0) << run.output;
    const BakeParams params = loadPvs(place / "x.pvs").params;
    EXPECT_EQ(params.n_rand, 20000u);
    EXPECT_EQ(params.n_abs_edge, 4u);
    EXPECT_EQ(params.delta_abs, 0.25f);
    EXPECT_EQ(params.delta_abs_relative, 0.0f);
    EXPECT_EQ(params.delta_rs, 0.985f);
    EXPECT_EQ(params.delta_rs_relative, 0.0f);
    EXPECT_EQ(params.threshold, 10u);
  }
}

TEST(BakeCommand, DrawsPicturesAlsoOfACompleteBake) {
  const Workplace place(1);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  const ProgramRun run = runProgram(place.bake("x.pvs", "--pictures " + (place / "new-folder")));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_TRUE(contains(run, "already complete")) << run.output;
  for (const char* name : {"new-folder/000-cell-0-outside.png", "new-folder/000-cell-0-inside.png"}) {
    const auto bytes = readBytes(place / name);
    ASSERT_GT(bytes.size(), 1000u);
    EXPECT_EQ(bytes[1], 'P');
  }
}

TEST(BakeCommand, FailuresAreOneLineBeforeTheWork) {
  const Workplace place(1);
  const auto expectLine = [](const std::string& arguments, int exit_code, const std::string& part) {
    const ProgramRun run = runProgram(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.output;
    EXPECT_TRUE(contains(run, part)) << arguments << "\n" << run.output;
    EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
    EXPECT_EQ(run.output.rfind("sightline: ", 0), 0u) << run.output;
  };
  expectLine(place.bake("none/x.pvs"), 1, "No such file or directory");
  expectLine(place.bake("x.pvs", "--report " + (place / "none/r.json")), 1, "none/r.json");
  expectLine(place.bake("."), 1, "is a folder");
  expectLine("bake missing.obj --cells " + (place / "cells.json") + " -o x.pvs --device cpu", 1,
             "missing.obj");
  expectLine("bake " + (place / "blocks.obj") + " --cells missing.json -o x.pvs --device cpu", 1,
             "missing.json");
  expectLine(place.bake("x.pvs", "--n-rand 0"), 2, "--n-rand");
  expectLine(place.bake("x.pvs", "--delta-abs nan"), 2, "--delta-abs");
  expectLine(place.bake("x.pvs", "--method raster"), 2, "use --device vulkan, not cpu");
  expectLine(place.bake("x.pvs", "--method raster --raster-resolution 8"), 2, "--raster-resolution");
  expectLine(place.bake("x.pvs", "--set other"), 2, "--set");
  expectLine(place.bake("x.pvs", "--nonsense"), 2, "--help");
  expectLine(place.bake("x.pvs", "--seed -1"), 2, "--seed");
  expectLine(place.bake("x.pvs", "--seed 18446744073709551616"), 2, "--seed");
  expectLine(place.bake("x.pvs", "--threshold 0"), 2, "never ends");
  expectLine("bake a.obj --cells c.json -o x.pvs --device gpu", 2, "sightline devices");
  writeBytes(place / "damaged.pvs", {1, 2, 3});
  expectLine(place.bake("damaged.pvs"), 1, "--overwrite");
  EXPECT_FALSE(std::filesystem::exists(place / "x.pvs.part"));
}

TEST(BakeCommand, AFullDiskIsAnErrorAndKeepsNothingFalse) {
  const Workplace place(30);
  ASSERT_EQ(runProgram(place.bake("whole.pvs")).exit_code, 0);
  // A limit on the size of files stands in for the disk: writing fails in the middle of a section.
  const std::string limit = "ulimit -f 2; exec '" SL_PROGRAM "' " + place.bake("x.pvs") + " 2>&1";
  const std::string log = place / "log";
  ASSERT_NE(std::system(("sh -c \"" + limit + "\" > " + log).c_str()), 0);
  EXPECT_NE(readText(log).find("x.pvs.part: cannot write: File too large"), std::string::npos)
      << readText(log);
  EXPECT_NE(readText(log).find("cells are kept"), std::string::npos) << readText(log);
  ASSERT_EQ(runProgram(place.bake("x.pvs")).exit_code, 0);
  expectSameBake(place / "x.pvs", place / "whole.pvs");
}

TEST(BakeCommand, WithoutOpenClItSaysHowAndDoesNotFallBack) {
  const Workplace place(1);
  const std::string none = "OCL_ICD_VENDORS=/nonexistent";
  const ProgramRun bake = runProgram(
      fmt::format("bake {} --cells {} -o {}", place / "blocks.obj", place / "cells.json", place / "x.pvs"),
      none);
  const ProgramRun devices = runProgram("devices", none);
  EXPECT_EQ(bake.exit_code, 1) << bake.output;
  EXPECT_TRUE(contains(bake, "pocl-opencl-icd")) << bake.output;
  EXPECT_TRUE(contains(bake, "--device cpu")) << bake.output;
  EXPECT_FALSE(std::filesystem::exists(place / "x.pvs.part"));
  EXPECT_EQ(devices.exit_code, 0);
  EXPECT_TRUE(contains(devices, "none found")) << devices.output;
}

TEST(BakeCommand, WithoutAVulkanDriverItSaysHowAndDoesNotFallBack) {
  const Workplace place(1);
  const std::string none = "VK_DRIVER_FILES=/nonexistent.json VK_ICD_FILENAMES=/nonexistent.json";
  const ProgramRun bake = runProgram(place.bake("x.pvs", "", "vulkan"), none);
  const ProgramRun devices = runProgram("devices", none);
  EXPECT_EQ(bake.exit_code, 1) << bake.output;
  EXPECT_TRUE(contains(bake, "no Vulkan driver: install")) << bake.output;
  EXPECT_FALSE(std::filesystem::exists(place / "x.pvs.part"));
  EXPECT_EQ(devices.exit_code, 0);
  EXPECT_TRUE(contains(devices, "no Vulkan driver: install")) << devices.output;
}

TEST(BakeCommand, ADeviceThatIsNotThereIsFoundBeforeTheTreeIsBuilt) {
  const Workplace place(1);
  const ProgramRun run = runProgram(place.bake("x.pvs", "", "opencl:nosuchdevice"));
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_TRUE(contains(run, "opencl:nosuchdevice")) << run.output;
  EXPECT_FALSE(contains(run, "tree: built")) << run.output;
}

TEST(BakeCommand, AClosedPipeDoesNotEndIt) {
  const Workplace place(3);
  const std::string command = "'" SL_PROGRAM "' " + place.bake("x.pvs") + " | true";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_TRUE(std::filesystem::exists(place / "x.pvs"));
}

}  // namespace
}  // namespace sightline
