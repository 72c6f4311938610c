#include "core/cli/whole_number.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "core/base/text.h"
#include "core/formats/load_scene.h"
#include "core/scene/scene.h"
#include "tests/cli/run_program.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::ProgramRun;
using test::runProgram;

TEST(WholeNumber, CountsAreReadAsTheyAreWritten) {
  const std::pair<const char*, uint64_t> kRead[] = {
      {"0", 0},
      {"007", 7},
      {"1000000", 1'000'000},
      {"10M", 10'000'000},
      {"10m", 10'000'000},
      {"250k", 250'000},
      {"250K", 250'000},
      {"12.3M", 12'300'000},
      {"0.5k", 500},
      {"1e6", 1'000'000},
      {"1E6", 1'000'000},
      {"1e+6", 1'000'000},
      {"2.5e3", 2500},
      {"50e-1", 5},
      {"1.000", 1},
      {"1e3k", 1'000'000},
      {"2G", 2'000'000'000},
      {"3T", 3'000'000'000'000},
      {"4P", 4'000'000'000'000'000},
      {"5E", 5'000'000'000'000'000'000},
      {"1.00E", 1'000'000'000'000'000'000},
      {"5e", 5'000'000'000'000'000'000},
      {"0e9", 0},
      {"0.000M", 0},
      {"18446744073709551615", UINT64_MAX},
      {"18446744073709.551615M", UINT64_MAX},
      {"1000000000000000000000000e-6", 1'000'000'000'000'000'000},
  };
  for (const auto& [text, value] : kRead) EXPECT_EQ(parseCount(text), value) << text;
}

TEST(WholeNumber, WhatIsNoCountIsRefused) {
  for (const char* text : {"",
                           "-5",
                           "+5",
                           "-0",
                           "1.5",
                           "1.5e0",
                           "0.0001k",
                           "1e-1",
                           "1e400",
                           "1e99999999999",
                           "1e-400",
                           "nan",
                           "NaN",
                           "inf",
                           "Infinity",
                           "M",
                           "k5",
                           "5kk",
                           "5KB",
                           "5B",
                           "5x",
                           "5 M",
                           " 5",
                           "5 ",
                           "5.",
                           ".5k",
                           "1..5k",
                           "1.5.0k",
                           "1,000",
                           "1_000",
                           "0x10",
                           "5e+",
                           "1e+-2",
                           "1e6.0",
                           "18446744073709551616",
                           "18446744073709551615.5",
                           "20E",
                           "99999999999999999999",
                           "5\n"}) {
    EXPECT_EQ(parseCount(text), std::nullopt) << '"' << text << '"';
  }
  EXPECT_EQ(parseCount(std::string_view("5\0", 2)), std::nullopt);
}

TEST(WholeNumber, BytesHaveUnitsOfBothKinds) {
  const std::pair<const char*, uint64_t> kRead[] = {
      {"1000", 1000},
      {"0", 0},
      {"5B", 5},
      {"4GB", 4'000'000'000},
      {"4G", 4'000'000'000},
      {"4gb", 4'000'000'000},
      {"4e9", 4'000'000'000},
      {"5.5GB", 5'500'000'000},
      {"4GiB", 4ull << 30},
      {"4Gi", 4ull << 30},
      {"4.0 GiB", 4ull << 30},
      {"1.5KiB", 1536},
      {"12.3 MiB", 12'897'484},  // and 0.8 of a byte
      {"1EB", 1'000'000'000'000'000'000},
      {"1EiB", 1ull << 60},
  };
  for (const auto& [text, value] : kRead) EXPECT_EQ(parseBytes(text), value) << text;
  for (const char* text : {"", "-5", "-5GB", "GB", "5 ", "5iB", "5Bi", "5GBB", "5GBs", "1.5", "1.5B", "5  GB",
                           "0.0001KiB", "16EiB", "1e400", "nan", "four GB"}) {
    EXPECT_EQ(parseBytes(text), std::nullopt) << '"' << text << '"';
  }
}

/// What the program prints as a short count can be given back to it, and is the same three digits again.
TEST(WholeNumber, ReadsWhatIsPrinted) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 5000; ++i) {
    const uint64_t count = random() >> (random() % 64);
    const std::string printed = shortCount(count);
    const auto read = parseCount(printed);
    ASSERT_TRUE(read.has_value()) << count << " " << printed;
    EXPECT_EQ(shortCount(*read), printed) << count;
    EXPECT_EQ(parseCount(std::to_string(count)), count);
  }
}

/// One line on wrong usage that names the value.
void expectRefused(const std::string& arguments, const std::string& part) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, 2) << arguments << "\n" << run.output;
  EXPECT_NE(run.output.find(part), std::string::npos) << arguments << "\n" << run.output;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << run.output;
}

/// What fails only because there is no such scene has had its options read.
void expectTaken(const std::string& arguments) {
  const ProgramRun run = runProgram(arguments);
  EXPECT_EQ(run.exit_code, 1) << arguments << "\n" << run.output;
  EXPECT_NE(run.output.find("/nonexistent"), std::string::npos) << arguments << "\n" << run.output;
}

TEST(WholeNumber, EveryCountTakesUnits) {
  const test::Folder folder;
  const std::string to = (folder / "x").string();
  const std::string bake = "bake /nonexistent.obj --cells c.json -o " + to + ".pvs ";
  const std::string compare = "compare /nonexistent.obj --cells c.json --rays 1M ";
  const std::string crosscheck = "crosscheck /nonexistent.obj --cells c.json --devices cpu ";
  const std::string measure = "measure /nonexistent.obj x.pvs ";
  const std::string verify = "verify /nonexistent.obj /nonexistent.pvs ";
  for (const std::string& option : {bake + "--n-rand",
                                    bake + "--n-abs-edge",
                                    bake + "--n-rs-edge",
                                    bake + "--n-rs-area",
                                    bake + "--reverse-stride",
                                    bake + "--raster-resolution",
                                    bake + "--threshold",
                                    bake + "--quiet-iterations",
                                    bake + "--max-rays",
                                    bake + "--validation-rays",
                                    bake + "--threads",
                                    bake + "--seed",
                                    compare + "--repeats",
                                    compare + "--missing-rays",
                                    compare + "--views",
                                    compare + "--resolution",
                                    crosscheck + "--rays",
                                    crosscheck + "--n-rand",
                                    crosscheck + "--check-every",
                                    crosscheck + "--max-wrong",
                                    crosscheck + "--seed",
                                    measure + "--views",
                                    measure + "--resolution",
                                    measure + "--seed",
                                    measure + "--max-wrong",
                                    verify + "--max-disproved"}) {
    for (const char* value : {"0.1k", "1e2", "100"}) expectTaken(option + " " + value);
    for (const char* value : {"1.5", "1e400", "nan", "5x", "99999999999999999999"}) {
      expectRefused(option + " " + value, value + std::string(" is not a whole number from"));
    }
    expectRefused(option + "=-5", "-5 is not a whole number from");
  }
  for (const char* option : {"--width", "--height"}) {
    const std::string picture = "picture s.obj /nonexistent.pvs --cell 0 -o x.png ";
    expectTaken(picture + option + " 0.5k");
    expectRefused(picture + option + " 1.5", "1.5 is not a whole number from");
  }
  expectTaken(bake + "--memory-budget 1.5GiB");
  expectTaken(compare + "--memory-budget 4GB");
  expectRefused(bake + "--n-rand 5G", "5G is not a whole number from 1 to 4294967293");
  expectRefused(bake + "--n-rand ''", "is empty; give a value");
  expectRefused(bake + "--max-rays 2E", "2E is not a whole number from 0 to 1e18");
  expectRefused(bake + "--memory-budget 1.5",
                "1.5 is not a whole number of bytes, such as 4000000000, 4GB or 3.7GiB");
}

TEST(WholeNumber, ACountWithAUnitIsTheCount) {
  const test::Folder folder;
  for (const char* count : {"3000", "3k", "3e3", "0.003M"}) {
    const std::string file = (folder / (std::string(count) + ".obj")).string();
    const ProgramRun run = runProgram("scene plant -o '" + file + "' --triangles " + count);
    ASSERT_EQ(run.exit_code, 0) << run.output;
    EXPECT_EQ(hashScene(loadScene(file)), hashScene(loadScene(folder / "3000.obj"))) << count;
  }
}

}  // namespace
}  // namespace sightline
