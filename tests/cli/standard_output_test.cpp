// "-" in the place of a file: standard output for text, a clear line for what is none, and never a file of
// that name.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/cli/run_separately.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

using test::runProgram;
using test::runSeparately;
using test::SeparateRun;

/// A folder with a small plant, one view cell in it and its bake with witnesses.
class StandardOutput : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const std::filesystem::path all = path() / "all.json";
    ASSERT_EQ(runProgram("scene plant -o '" + (path() / "s.obj").string() + "' --triangles 2000 --cells '" +
                         all.string() + "'")
                  .exit_code,
              0);
    const auto cells = nlohmann::json::parse(std::ifstream(all));
    std::ofstream(path() / "c.json") << nlohmann::json{{"cells", {cells["cells"][0]}}};
    ASSERT_EQ(runIn(kBake + "-o x.pvs --witnesses").exit_code, 0);
  }
  static void TearDownTestSuite() { delete folder_; }
  void TearDown() override { EXPECT_FALSE(std::filesystem::exists(path() / "-")); }

  static const std::filesystem::path& path() { return folder_->path(); }
  static SeparateRun runIn(const std::string& arguments) { return runSeparately(arguments, path()); }
  static std::string read(const char* file) {
    const auto bytes = readBytes((path() / file).string());
    return {bytes.begin(), bytes.end()};
  }
  /// The command with --OPTION FILE writes to FILE what it writes to standard output with -, but for what
  /// differs between two runs; what it says goes to standard error then.
  static SeparateRun expectSame(const std::string& command, const std::string& option, bool differs = false) {
    const SeparateRun file = runIn(command + " " + option + " file"),
                      piped = runIn(command + " " + option + " -");
    EXPECT_EQ(file.exit_code, 0) << file.errors;
    EXPECT_EQ(piped.exit_code, 0) << piped.errors;
    if (!differs) {
      EXPECT_EQ(piped.output, read("file")) << command;
    }
    EXPECT_GT(file.output.size(), 0u) << command;
    EXPECT_EQ(file.errors, "") << command;
    EXPECT_GT(piped.errors.size(), 0u) << command;
    return piped;
  }
  static const std::string kBake;

 private:
  static TemporaryFolder* folder_;
};

const std::string StandardOutput::kBake =
    "bake s.obj --cells c.json --device cpu --n-rand 10000 --validation-rays 10000 --n-abs-edge 3 ";
TemporaryFolder* StandardOutput::folder_ = nullptr;

TEST_F(StandardOutput, TakesExportsThatAreText) {
  const SeparateRun ids = expectSame("export x.pvs --cell 0 --format ids", "-o");
  const PvsFile pvs = loadPvs(path() / "x.pvs");
  EXPECT_EQ(size_t(std::count(ids.output.begin(), ids.output.end(), '\n')), pvs.cells[0].triangles.size());
  expectSame("export x.pvs --cell 0 --format json --scene s.obj", "--output");
  ASSERT_EQ(runIn("export x.pvs --cell 0 --format obj --scene s.obj -o seen.obj").exit_code, 0);
  EXPECT_EQ(runIn("export x.pvs --cell 0 --format obj --scene s.obj -o -").output, read("seen.obj"));
}

TEST_F(StandardOutput, TakesAScene) {
  EXPECT_EQ(runIn("scene plant -o - --triangles 2000").output, read("s.obj"));
}

TEST_F(StandardOutput, TakesReportsTablesAndPages) {
  const std::string bake = kBake + "-o x.pvs --witnesses";  // which is complete
  const SeparateRun report = expectSame(bake, "--report", true);
  EXPECT_EQ(nlohmann::json::parse(report.output)["complete"], true);
  EXPECT_NE(report.errors.find("already complete"), std::string::npos) << report.errors;
  expectSame(bake, "--csv");
  EXPECT_EQ(expectSame(bake, "--html", true).output.rfind("<!DOCTYPE html>", 0), 0u);

  const std::string measure = "measure s.obj x.pvs --device cpu --views 2 --resolution 16";
  EXPECT_TRUE(nlohmann::json::accept(expectSame(measure, "--report", true).output));
  expectSame(measure, "--csv");
  EXPECT_EQ(expectSame(measure, "--html", true).output.rfind("<!DOCTYPE html>", 0), 0u);

  const std::string crosscheck = "crosscheck s.obj --cells c.json --devices cpu --rays 100";
  EXPECT_TRUE(nlohmann::json::accept(expectSame(crosscheck, "--report", true).output));
  EXPECT_TRUE(nlohmann::json::accept(expectSame("verify s.obj x.pvs --min-proven 0", "--report").output));

  const std::string compare =
      "compare s.obj --cells c.json --device cpu --rays 20000 --n-rand 5000 --methods random --views 2 "
      "--resolution 16 "
      "--points 1 --missing-rays 1000";
  EXPECT_TRUE(nlohmann::json::accept(expectSame(compare, "--report", true).output));
  EXPECT_EQ(expectSame(compare, "--csv", true).output.rfind("cell,", 0), 0u);
}

TEST_F(StandardOutput, RefusesWhatIsNoText) {
  for (const std::string& arguments :
       {kBake + "-o -", kBake + "-o n.pvs --pictures -", std::string("verify s.obj x.pvs -o -"),
        std::string("picture s.obj x.pvs --cell 0 -o -"), std::string("measure s.obj x.pvs --pictures -"),
        std::string("export x.pvs --cell 0 --format glb --scene s.obj -o -"),
        std::string("scene plant -o n.obj --cells -")}) {
    const SeparateRun run = runIn(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments << run.errors;
    EXPECT_EQ(run.output, "") << arguments;
    EXPECT_NE(run.errors.find(": - is standard output, where "), std::string::npos) << run.errors;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_FALSE(std::filesystem::exists(path() / "n.obj"));
  }
  const SeparateRun twice = runIn(kBake + "-o x.pvs --witnesses --report - --csv -");
  EXPECT_EQ(twice.exit_code, 2) << twice.errors;
  EXPECT_NE(twice.errors.find("written twice"), std::string::npos) << twice.errors;
}

TEST_F(StandardOutput, SaysWhenItCannotBeWrittenButNotWhenItsReaderWentAway) {
  const std::string program = "cd '" + path().string() + "' && '" SL_PROGRAM "' ";
  const std::string ids = program + "export x.pvs --cell 0 --format ids -o - ";
  EXPECT_EQ(std::system((ids + "2>errors >/dev/full").c_str()), 1 << 8);
  EXPECT_NE(read("errors").find("cannot write to standard output: No space left"), std::string::npos);
  EXPECT_EQ(std::system((ids + "2>errors | true").c_str()), 0);
  EXPECT_EQ(read("errors").find("sightline: "), std::string::npos) << read("errors");
  EXPECT_EQ(std::system((ids + "2>errors >&-").c_str()), 1 << 8);
}

/// ./- is a file as any other.
TEST_F(StandardOutput, AFileOfThatNameHasAFolder) {
  EXPECT_EQ(runIn("export x.pvs --cell 0 --format ids -o ./-").exit_code, 0);
  EXPECT_TRUE(std::filesystem::remove(path() / "-"));
}

}  // namespace
}  // namespace sightline
