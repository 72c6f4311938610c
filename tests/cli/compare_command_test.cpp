#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/run_program.h"
#include "tests/support/temporary_folder.h"

namespace sightline::test {
namespace {

class CompareCommand : public testing::Test {
 protected:
  CompareCommand() {
    const ProgramRun made = runProgram("scene city --triangles 3000 -o " + scene() + " --cells " + cells());
    if (made.exit_code != 0) throw std::runtime_error(made.output);
  }
  std::string file(const std::string& name) { return (folder_ / name).string(); }
  std::string scene() { return file("city.glb"); }
  std::string cells() { return file("cells.json"); }
  std::string compare(const std::string& rest) {
    return "compare " + scene() + " --cells " + cells() +
           " --device cpu --n-rand 5000 --views 2 --resolution 32 " + rest;
  }
  void expectRefused(const std::string& rest, const std::string& part) {
    const ProgramRun run = runProgram(compare(rest));
    EXPECT_EQ(run.exit_code, 2) << run.output;
    EXPECT_NE(run.output.find(part), std::string::npos) << run.output;
  }
  std::string read(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  TemporaryFolder folder_;
};

TEST_F(CompareCommand, WritesTableJsonCsvAndPage) {
  const std::string json = file("r.json"), csv = file("r.csv"), html = file("r.html");
  const ProgramRun run = runProgram(compare(
      "--methods gvs++,gvs,random,naive --rays 30000 --repeats 2 --points 2 --missing-rays 5000 --report " +
      json + " --csv " + csv + " --html " + html));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  for (const char* name : {"gvs++", "gvs ", "random", "naive"}) {
    EXPECT_NE(run.output.find(std::string("\n") + name), std::string::npos) << run.output;
  }
  const auto report = nlohmann::json::parse(read(json));
  EXPECT_EQ(report["points"].size(), 2u);
  EXPECT_EQ(report["points"][1]["methods"].size(), 4u);
  EXPECT_EQ(report["parameters"]["n_rand"], 5000);
  EXPECT_EQ(report["parameters"]["max_rays"], 30000);
  for (const char* key : {"method", "validation_rays"}) {
    EXPECT_FALSE(report["parameters"].contains(key)) << key << ": there is not one of it";
  }
  const auto& runs = report["cells"][0]["runs"];
  ASSERT_EQ(runs.size(), 8u);
  // The naive implementation finds the very set of gvs++.
  for (const char* key : {"triangles", "rays", "average_wrong", "missing_share"}) {
    EXPECT_EQ(runs[0]["points"][1][key], runs[6]["points"][1][key]) << key;
  }
  EXPECT_LE(runs[0]["points"][1]["rays"], 30000);
  EXPECT_NE(runs[0]["points"][1], runs[1]["points"][1]) << "two seeds";
  const std::string lines = read(csv);
  const auto cell_count = report["cells"].size();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), int(1 + cell_count * 8 * 2));
  const std::string page = read(html);
  EXPECT_NE(page.find("Average error over rays"), std::string::npos);
  EXPECT_NE(page.find("<dt>random rays an iteration</dt>"), std::string::npos);
  EXPECT_EQ(page.find("<dt>method</dt>"), std::string::npos);
  EXPECT_EQ(page.find("<dt>validation rays</dt>"), std::string::npos);
}

TEST_F(CompareCommand, RefusesWhatMakesNoSense) {
  expectRefused("", "--rays N or --seconds S");
  expectRefused("--rays 0", "--rays");
  expectRefused("--seconds nan", "--seconds");
  expectRefused("--rays 1000 --methods gvs++,best", "best");
  expectRefused("--rays 1000 --methods gvs,random,gvs", "--methods: gvs is named twice");
  expectRefused("--rays 1000 --points 0", "--points");
  expectRefused("--rays 1000 --methods raster", "--device vulkan");
  expectRefused("--rays 1000 --report " + scene(), "read and replaced");
}

/// Before the bakes, not after them.
TEST_F(CompareCommand, RefusesMoreViewsThanMeasureTakes) {
  for (const char* option : {"--views 1000001", "--resolution 4097"}) {
    const ProgramRun run =
        runProgram("compare " + scene() + " --cells " + cells() + " --device cpu --rays 1000 " + option);
    EXPECT_EQ(run.exit_code, 2) << run.output;
    EXPECT_NE(run.output.find("is not a whole number from 1 to"), std::string::npos) << run.output;
  }
}

}  // namespace
}  // namespace sightline::test
