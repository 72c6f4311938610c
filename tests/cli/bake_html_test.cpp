#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "core/pvs/pvs_writer.h"
#include "tests/cli/run_program.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::runProgram;

std::string textOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> linesOf(const std::filesystem::path& file) {
  std::istringstream text(textOf(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// A small city and one cell in it with a name that must be escaped.
class BakeHtml : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(runProgram("scene city --triangles 2000 -o " + path("city.glb")).exit_code, 0);
    std::ofstream(folder_ / "cells.json")
        << R"({"cells":[{"name":"</script><b>\"x\", y","center":[0,30,0],"size":[4,2,4]}]})";
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string bake(const std::string& more) const {
    return "bake " + path("city.glb") + " --cells " + path("cells.json") + " -o " + path("city.pvs") +
           " --device cpu --overwrite --n-rand 20000 --n-abs-edge 4 --n-rs-edge 4 --n-rs-area 4 "
           "--validation-rays 1000 " +
           more;
  }

  TemporaryFolder folder_;
};

TEST_F(BakeHtml, WritesPageCsvAndJsonThatAgree) {
  const ProgramRun run = runProgram(bake("--html " + path("r.html") + " --csv " + path("r.csv") +
                                         " --report " + path("r.json") + " --pictures " + path("pictures")));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const std::string html = textOf(folder_ / "r.html");
  EXPECT_NE(html.find("&lt;/script&gt;&lt;b&gt;&quot;x&quot;, y"), std::string::npos);
  EXPECT_EQ(html.find("<b>\"x"), std::string::npos);
  EXPECT_NE(html.find("<pre>sightline bake "), std::string::npos);
  const json cell = json::parse(textOf(folder_ / "r.json"))["cells"][0];
  EXPECT_NE(html.find(fmt::format("<td>{}</td>", cell["pvs_size"].dump())), std::string::npos);
  size_t pictures = 0;
  for (size_t at = 0; (at = html.find("src=\"data:image/png;base64,iVBOR", at)) != std::string::npos; ++at)
    ++pictures;
  EXPECT_EQ(pictures, 2u);

  const std::string last = linesOf(folder_ / "r.csv").back();
  const json& stages = cell["stages"];
  const std::string begin = fmt::format(R"("</script><b>""x"", y",{},)", cell["iterations"].dump());
  EXPECT_TRUE(last.starts_with(begin)) << last;
  std::string sums;
  for (const char* key : {"rays", "new_triangles"}) {
    for (const char* stage : {"random", "border", "reverse"})
      sums += fmt::format(",{}", stages[stage][key].dump());
  }
  EXPECT_TRUE(last.ends_with(fmt::format("{},{}", sums, cell["pvs_size"].dump()))) << last << " and " << sums;
}

/// A bake that goes on has the totals of all cells, those of the earlier run in one line each.
TEST_F(BakeHtml, CsvHoldsTheCellsOfAnEarlierRun) {
  std::ofstream(folder_ / "cells.json") << R"({"cells":[{"name":"a","center":[0,30,0],"size":[4,2,4]},
      {"name":"b","center":[0,40,0],"size":[4,2,4]},{"name":"c","center":[0,50,0],"size":[4,2,4]}]})";
  ASSERT_EQ(runProgram(bake("--csv " + path("whole.csv"))).exit_code, 0);
  const PvsFile whole = loadPvs(folder_ / "city.pvs");
  std::filesystem::remove(folder_ / "city.pvs");
  {
    PvsWriter stopped(folder_ / "city.pvs.part");
    stopped.begin(whole);
    for (const size_t cell : {0, 1}) stopped.append(whole.cells[cell]);
  }
  const std::string going_on =
      std::regex_replace(bake("--csv " + path("rest.csv")), std::regex("--overwrite"), "");
  const ProgramRun run = runProgram(going_on);
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_NE(run.output.find("2 of 3 cells"), std::string::npos) << run.output;
  // Cell by cell the last line, without the seconds; and how many lines.
  const auto ends = [&](const std::string& file) {
    std::map<std::string, std::pair<int, std::string>> by_cell;
    for (const std::string& line : linesOf(folder_ / file)) {
      auto& [lines, end] = by_cell[line.substr(0, line.find(','))];
      ++lines;
      end = std::regex_replace(line, std::regex("^([^,]*,[^,]*),[^,]*"), "$1");
    }
    return by_cell;
  };
  auto before = ends("whole.csv"), after = ends("rest.csv");
  ASSERT_EQ(after.size(), 1u + 3);
  for (const char* cell : {"a", "b", "c"}) EXPECT_EQ(after[cell].second, before[cell].second);
  EXPECT_EQ(after["a"].first, 1);
  EXPECT_EQ(after["b"].first, 1);
  EXPECT_EQ(after["c"].first, before["c"].first);
  EXPECT_GT(after["c"].first, 1);
}

/// Pictures that cannot be drawn do not cost the curves, which no later run has.
TEST_F(BakeHtml, KeepsPageAndCsvWherePicturesFail) {
  std::ofstream(folder_ / "cells.json") << R"({"cells":[{"name":"a","center":[0,30,0],"size":[4,2,4]},
      {"name":"b","center":[0,40,0],"size":[4,2,4]}]})";
  std::filesystem::create_directories(folder_ / "pictures" / "001-b-outside.png");
  const ProgramRun run = runProgram(bake("--csv " + path("curves.csv") + " --html " + path("page.html") +
                                         " --pictures " + path("pictures")));
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_NE(run.output.find("001-b-outside.png"), std::string::npos) << run.output;
  EXPECT_GT(linesOf(folder_ / "curves.csv").size(), 3u);
  EXPECT_NE(textOf(folder_ / "page.html").find("a from outside"), std::string::npos);
}

TEST_F(BakeHtml, RefusesToReplaceItsInputsAndWhatCannotBeWritten) {
  ProgramRun run = runProgram(bake("--html " + path("city.glb")));
  EXPECT_EQ(run.exit_code, 2) << run.output;
  run = runProgram(bake("--csv " + path("city.pvs")));
  EXPECT_EQ(run.exit_code, 2) << run.output;
  run = runProgram(bake("--html " + path("no/such/folder.html")));
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "city.pvs")) << "it said so before the work";
}

}  // namespace
}  // namespace sightline
