// What is mistyped is named, with what was probably meant.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "core/base/nearest.h"
#include "tests/cli/run_program.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::runProgram;

/// One line on wrong usage, with all parts in it.
void expectUsage(const std::string& arguments, std::initializer_list<const char*> parts) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.output;
  for (const char* part : parts) {
    EXPECT_NE(run.output.find(part), std::string::npos) << arguments << ": no " << part << "\n" << run.output;
  }
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << arguments << "\n" << run.output;
  EXPECT_EQ(run.output.rfind("sightline: ", 0), 0u) << arguments << "\n" << run.output;
}

/// The same, without a suggestion.
void expectUsageWithoutMeaning(const std::string& arguments, std::initializer_list<const char*> parts) {
  expectUsage(arguments, parts);
  EXPECT_EQ(runProgram(arguments).output.find("did you mean"), std::string::npos) << arguments;
}

TEST(Usage, NamesAnUnknownCommandAndTheNearest) {
  expectUsage("baek city.glb", {"unknown command baek; did you mean bake?", "(see: sightline --help)"});
  expectUsage("Bake", {"unknown command Bake; did you mean bake?"});
  expectUsage("cel", {"unknown command cel; did you mean cells?"});
  expectUsage("cross --cells c.json", {"did you mean crosscheck?"});
  expectUsage("dveices", {"did you mean devices?"});
  expectUsageWithoutMeaning("nonsense", {"unknown command nonsense", "(see: sightline --help)"});
  expectUsageWithoutMeaning("''", {"unknown command ''"});
  expectUsageWithoutMeaning("\"$(printf 'a\\nb')\"", {"unknown command 'a?b'"});
}

TEST(Usage, NamesAnUnknownOptionAndTheNearest) {
  // Before what is missing, or taken for something else, because of it.
  expectUsage("bake s.obj --cellz c.json -o x.pvs",
              {"unknown option --cellz; did you mean --cells?", "(see: sightline bake --help)"});
  expectUsage("bake --cellz=c.json", {"unknown option --cellz; did you mean --cells?"});
  expectUsage("bake s.obj --cells c.json -o x.pvs --n_rand 5 --method none",
              {"--n_rand; did you mean --n-rand?"});
  expectUsage("bake s.obj -cells c.json", {"unknown option -cells; did you mean --cells?"});
  expectUsage("bake s.obj --cells c.json -output x.pvs", {"unknown option -output; did you mean --output?"});
  expectUsage("measure s.obj x.pvs --veiws 5", {"unknown option --veiws; did you mean --views?"});
  expectUsage("crosscheck s.obj --device cpu", {"unknown option --device; did you mean --devices?"});
  expectUsage("--versoin", {"unknown option --versoin; did you mean --version?", "(see: sightline --help)"});
  expectUsageWithoutMeaning("bake s.obj --cells c.json -o x.pvs --quality 5", {"unknown option --quality"});
  expectUsageWithoutMeaning("bake s.obj -x 5", {"unknown option -x"});
  expectUsageWithoutMeaning("--cells c.json bake s.obj", {"unknown option --cells"});
}

TEST(Usage, NamesAnUnknownValueAndTheNearest) {
  const std::string bake = "bake s.obj --cells c.json -o x.pvs ";
  expectUsage(bake + "--method gsv++",
              {"--method: gsv++ is none of gvs++, gvs, random, raster, naive; did you mean gvs++?"});
  expectUsage(bake + "--order yeild", {"--order: yeild is none of yield, queue; did you mean yield?"});
  expectUsage(bake + "--set hahs", {"--set: hahs is none of auto, array, hash; did you mean hash?"});
  expectUsage(bake + "--device openlc", {"no device \"openlc\"", "did you mean opencl?"});
  expectUsage("compare s.obj --cells c.json --rays 9 --methods gvs,rnadom", {"did you mean random?"});
  expectUsage("crosscheck s.obj --cells c.json --devices cpu,vulcan", {"did you mean vulkan?"});
  expectUsage("crosscheck s.obj --cells c.json --devices cpu --kinds edge,vertx", {"did you mean vertex?"});
  expectUsage("picture s.obj x.pvs --cell 0 -o p.png --view insde", {"did you mean inside?"});
  expectUsage("picture s.obj x.pvs --cell 0 -o p.png --device vulkn", {"did you mean vulkan?"});
  expectUsage("export x.pvs --cell 0 -o x --format jsn", {"did you mean json?"});
  expectUsage("scene ctiy -o x.obj",
              {"ctiy is none of city, canyon, plant, bistro, scan; did you mean city?"});
  expectUsage("cells s.obj -o c.json --grid 4 --free-side bcak", {"did you mean back?"});
  expectUsageWithoutMeaning(bake + "--method best", {"best is none of gvs++"});
}

TEST(Usage, SaysWhatIsGivenTwiceOrWithoutAValue) {
  expectUsage("bake s.obj --cells c.json -o x.pvs --method gvs --method random",
              {"--method is given 2 times; give it once", "(see: sightline bake --help)"});
  expectUsage("bake s.obj --cells c.json -o x.pvs -o y.pvs -o z.pvs",
              {"--output is given 3 times; give it once"});
  expectUsage("bake s.obj -o x.pvs --cells", {"--cells needs a value: CELLS.json"});
  expectUsage("bake s.obj --cells -o x.pvs", {"--cells: needs a value, and -o is an option"});
  expectUsage("bake s.obj --cells c.json -o x.pvs --method --overwrite",
              {"--method: needs a value, and --overwrite is an option"});
  expectUsage("info a.obj b.obj", {"unexpected argument b.obj"});
}

/// A list ends at its comma, and does not take the scene after it.
TEST(Usage, ListsTakeNoFurtherWords) {
  const ProgramRun run = runProgram("crosscheck --devices cpu,opencl /nonexistent.obj --cells c.json");
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_NE(run.output.find("/nonexistent.obj: cannot open"), std::string::npos) << run.output;
}

TEST(Nearest, EditDistanceCountsSlips) {
  EXPECT_EQ(editDistance("", ""), 0u);
  EXPECT_EQ(editDistance("", "abc"), 3u);
  EXPECT_EQ(editDistance("abc", "abc"), 0u);
  EXPECT_EQ(editDistance("abc", "abxc"), 1u);
  EXPECT_EQ(editDistance("abc", "ac"), 1u);
  EXPECT_EQ(editDistance("abc", "axc"), 1u);
  EXPECT_EQ(editDistance("abc", "acb"), 1u);
  EXPECT_EQ(editDistance("ca", "abc"), 3u);
  std::mt19937 random(7);
  const auto word = [&] {
    std::string text(random() % 7, 'a');
    for (char& c : text) c = char('a' + random() % 3);
    return text;
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string a = word(), b = word();
    EXPECT_EQ(editDistance(a, b), editDistance(b, a)) << a << " " << b;
    EXPECT_EQ(editDistance(a, b) == 0, a == b) << a << " " << b;
    EXPECT_LE(editDistance(a, b), std::max(a.size(), b.size())) << a << " " << b;
    EXPECT_GE(editDistance(a, b) + std::min(a.size(), b.size()), std::max(a.size(), b.size()))
        << a << " " << b;
  }
}

TEST(Nearest, NamesNothingThatIsFar) {
  const std::array<std::string, 5> names = {"--report", "--repair", "--rays", "-o", "--max-rays"};
  EXPECT_EQ(nearestName("--reprot", names), "--report");
  EXPECT_EQ(nearestName("--ray", names), "--rays");
  EXPECT_EQ(nearestName("--RAYS", names), "--rays");
  EXPECT_EQ(nearestName("--max", names), "--max-rays");  // the only one that begins so
  EXPECT_EQ(nearestName("--rep", names), "");            // two do
  EXPECT_EQ(nearestName("-O", names), "-o");
  EXPECT_EQ(nearestName("-x", names), "");
  EXPECT_EQ(nearestName("--", names), "");
  EXPECT_EQ(nearestName("", names), "");
  EXPECT_EQ(nearestName("--overwrite", names), "");
}

}  // namespace
}  // namespace sightline
