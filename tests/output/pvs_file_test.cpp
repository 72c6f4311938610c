#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <thread>

#include "core/bake/require_scene.h"
#include "core/base/error.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"
#include "core/pvs/set_codec.h"
#include "tests/output/example_pvs.h"
#include "tests/output/version_3_file.h"

namespace sightline {
namespace {

Bytes costBytes(const CellPvs& cell) {
  ByteWriter out;
  PvsFile head;
  if (cell.open) head.doors = {{"door", 0, 1}};
  writeCost(out, costOf(cell, 0), head);
  return out.bytes();
}

void expectEqual(const CellPvs& got, const CellPvs& want) {
  EXPECT_EQ(got.cell.name, want.cell.name);
  EXPECT_EQ(got.cell.center, want.cell.center);
  EXPECT_EQ(got.cell.size, want.cell.size);
  EXPECT_EQ(got.cell.rotation, want.cell.rotation);
  EXPECT_EQ(got.triangles, want.triangles);
  PvsFile head;
  head.has_witnesses = !want.witnesses.empty();
  if (want.open) head.doors = {{"door", 0, 1}};
  EXPECT_EQ(writeCellPayload(got, 0, head), writeCellPayload(want, 0, head));  // statistics, open set
  EXPECT_EQ(costBytes(got), costBytes(want));
  ASSERT_EQ(got.witnesses.size(), want.witnesses.size());
  for (size_t i = 0; i < want.witnesses.size(); ++i) {
    EXPECT_EQ(got.witnesses[i].origin, want.witnesses[i].origin) << i;
    EXPECT_EQ(got.witnesses[i].direction, want.witnesses[i].direction) << i;
    EXPECT_EQ(got.witnesses[i].stage, want.witnesses[i].stage) << i;
  }
}

void expectEqual(const PvsFile& got, const PvsFile& want) {
  EXPECT_EQ(got.algorithm, want.algorithm);
  EXPECT_EQ(got.intersector, want.intersector);
  EXPECT_EQ(got.scene_hash, want.scene_hash);
  EXPECT_EQ(got.triangle_count, want.triangle_count);
  EXPECT_EQ(got.scene_name, want.scene_name);
  EXPECT_EQ(got.device, want.device);
  EXPECT_EQ(got.params, want.params);
  EXPECT_EQ(got.has_witnesses, want.has_witnesses);
  ASSERT_EQ(got.planned.size(), want.planned.size());
  for (size_t i = 0; i < want.planned.size(); ++i) EXPECT_EQ(got.planned[i].name, want.planned[i].name);
  ASSERT_EQ(got.cells.size(), want.cells.size());
  for (size_t i = 0; i < want.cells.size(); ++i) expectEqual(got.cells[i], want.cells[i]);
}

/// The message of the Error that reading `bytes` throws; empty if they are sound.
std::string problemOf(const std::vector<uint8_t>& bytes) {
  try {
    parsePvs(bytes, "y.pvs");
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

/// The bytes of the example's file.
std::vector<uint8_t> exampleBytes() {
  TemporaryFolder folder;
  savePvs(examplePvs(), folder / "x.pvs");
  return readBytes(folder / "x.pvs");
}

/// Sets the section's checksum right, so that a reader must find the lie by itself.
void fixChecksum(std::vector<uint8_t>& bytes, size_t section) {
  uint64_t size = 0;
  std::memcpy(&size, bytes.data() + section + 8, 8);
  const uint64_t hash = XXH3_64bits(bytes.data() + section, 16 + size);
  std::memcpy(bytes.data() + section + 16 + size, &hash, 8);
}

/// Sets the checksum of the whole file right, too.
void fixEnd(std::vector<uint8_t>& bytes) {
  const size_t end = bytes.size() - 40;
  const uint64_t hash = XXH3_64bits(bytes.data(), end);
  std::memcpy(bytes.data() + end + 16 + 8, &hash, 8);
  fixChecksum(bytes, end);
}

TEST(PvsFile, ComesBackAsItWas) {
  TemporaryFolder folder;
  for (bool witnesses : {false, true}) {
    const PvsFile pvs = examplePvs(witnesses);
    savePvs(pvs, folder / "x.pvs");
    expectEqual(loadPvs(folder / "x.pvs"), pvs);
    savePvs(pvs, folder / "y.pvs");
    EXPECT_EQ(readBytes(folder / "x.pvs"), readBytes(folder / "y.pvs"));
  }
}

TEST(PvsFile, LeavesNothingBesideIt) {
  TemporaryFolder folder;
  savePvs(examplePvs(), folder / "x.pvs");
  savePvs(examplePvs(), folder / "x.pvs");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_THROW(savePvs(examplePvs(), folder / "none/x.pvs"), Error);
}

/// Whoever is faster, both files were whole: the last stays, and nothing beside it.
TEST(PvsFile, SavedTwiceAtOnceIsOneOfTheTwo) {
  TemporaryFolder folder;
  const auto save = [&](uint64_t seed) {
    PvsFile pvs = examplePvs();
    pvs.params.seed = seed;
    for (int round = 0; round < 200; ++round) savePvs(pvs, folder / "x.pvs");
  };
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      save(1);
      ::_exit(0);
    } catch (const Error&) {
      ::_exit(1);
    }
  }
  std::thread thread([&] { EXPECT_NO_THROW(save(2)); });
  EXPECT_NO_THROW(save(3));
  thread.join();
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_LE(loadPvs(folder / "x.pvs").params.seed, 3u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(PvsFile, SavingLeavesTheFileOfAnotherWriterAlone) {
  TemporaryFolder folder;
  PvsWriter other(folder / "x.pvs.tmp");
  other.begin(examplePvs());
  EXPECT_NO_THROW(savePvs(examplePvs(), folder / "x.pvs"));
  EXPECT_TRUE(std::filesystem::exists(folder / "x.pvs.tmp"));
  EXPECT_NO_THROW(loadPvs(folder / "x.pvs"));
}

TEST(PvsFile, Version3IsStillRead) {
  PvsFile want = examplePvs();
  want.algorithm = 1;
  want.intersector = "";
  const PvsFile got = parsePvs(kVersion3File, "x.pvs");
  EXPECT_EQ(got.version, 3u);
  expectEqual(got, want);
}

/// The sections of `pvs` between HEAD and END.
struct Sections {
  explicit Sections(const PvsFile& pvs) : head(writeSection(kSectionHead, writeHeadPayload(pvs))) {
    for (uint32_t i = 0; i < pvs.cells.size(); ++i) {
      cells.push_back(writeSection(kSectionCell, writeCellPayload(pvs.cells[i], i, pvs)));
      ByteWriter cost;
      writeCost(cost, costOf(pvs.cells[i], i), pvs);
      costs.push_back(writeSection(kSectionCost, cost.bytes()));
    }
  }

  /// A file that has these after its head.
  Bytes file(std::initializer_list<Bytes> sections, uint32_t cell_count) const {
    ByteWriter out;
    out.raw(writePrelude(kPvsMagic, 4));
    out.raw(head);
    for (const Bytes& section : sections) out.raw(section);
    const Bytes& all = out.bytes();
    const Bytes end = writeEndPayload(cell_count, XXH3_64bits(all.data(), all.size()));
    out.raw(writeSection(kSectionEnd, end));
    return out.bytes();
  }

  Bytes head;
  std::vector<Bytes> cells, costs;
};

TEST(PvsFile, CellsComeInAnyOrder) {
  const PvsFile want = examplePvs();
  const Sections s(want);
  expectEqual(parsePvs(s.file({s.cells[1], s.costs[1], s.cells[0], s.costs[0]}, 2), "x.pvs"), want);
  expectEqual(parsePvs(s.file({s.costs[0], s.costs[1], s.cells[0], s.cells[1]}, 2), "x.pvs"), want);
  const auto expectProblem = [&](const Bytes& bytes, const char* part) {
    EXPECT_NE(problemOf(bytes).find(part), std::string::npos) << problemOf(bytes);
  };
  expectProblem(s.file({s.cells[0], s.costs[0], s.cells[0]}, 2), "a cell comes twice");
  expectProblem(s.file({s.cells[0], s.costs[0], s.costs[0]}, 1), "times of a cell come twice");
  expectProblem(s.file({s.cells[0], s.cells[1], s.costs[0]}, 2), "missing");
  expectProblem(s.file({s.cells[1], s.costs[1]}, 1), "missing");
  expectProblem(s.file({s.cells[0], s.costs[1]}, 1), "missing");
}

TEST(PvsFile, PlannedCellsAreCheckedAsThoseOfACellsFile) {
  const auto expectProblem = [](auto change, const char* part) {
    TemporaryFolder folder;
    PvsFile pvs = examplePvs();
    change(pvs.planned[1]);
    savePvs(pvs, folder / "x.pvs");
    const std::string problem = problemOf(readBytes(folder / "x.pvs"));
    EXPECT_NE(problem.find(part), std::string::npos) << problem;
    EXPECT_NE(problem.find("y.pvs: byte 16: cells[1]"), std::string::npos) << problem;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = HUGE_VAL;
  expectProblem([&](ViewCell& cell) { cell.center.y = nan; }, "center[1]: is not a finite number");
  expectProblem([&](ViewCell& cell) { cell.rotation.z = infinity; }, "rotation[2]: is not a finite number");
  expectProblem([&](ViewCell& cell) { cell.size.x = nan; }, "size[0]: is not a finite number");
  expectProblem([](ViewCell& cell) { cell.size = {0, 0, 1}; }, "size: the cell has no area");
  expectProblem([](ViewCell& cell) { cell.size.z = -1; }, "size[2]: -1 is negative");
  expectProblem([](ViewCell& cell) { cell.size.z = 1e-300; }, "size[2]: 1e-300 is too small");
  expectProblem([](ViewCell& cell) { cell.center.x = 1e30; }, "reaches farther than 2^40");
  expectProblem([](ViewCell& cell) { cell.name = ""; }, "name: is empty");
  expectProblem([](ViewCell& cell) { cell.name = "a"; }, "is the name of an earlier cell");
  expectProblem([](ViewCell& cell) { cell.name = "\x1b[2J"; }, "name: has a control character");
}

TEST(PvsFile, TimesAndBoundsAreNumbersThatMeanSomething) {
  const auto problem = [](auto change) {
    TemporaryFolder folder;
    PvsFile pvs = examplePvs();
    change(pvs.cells[0].stats);
    savePvs(pvs, folder / "x.pvs");
    return problemOf(readBytes(folder / "x.pvs"));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(problem([&](CellStats& stats) { stats.seconds = nan; }), "");
  EXPECT_NE(problem([](CellStats& stats) { stats.border.seconds = -1; }), "");
  EXPECT_NE(problem([&](CellStats& stats) { stats.error_bound = nan; }), "");
  EXPECT_NE(problem([](CellStats& stats) { stats.error_bound = 1.5; }), "");
}

TEST(PvsFile, EveryFlippedBitIsAnError) {
  auto bytes = exampleBytes();
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (unsigned bit : {0u, 3u, 7u}) {
      bytes[i] ^= uint8_t(1u << bit);
      EXPECT_NE(problemOf(bytes), "") << "byte " << i << " bit " << bit;
      bytes[i] ^= uint8_t(1u << bit);
    }
  }
}

TEST(PvsFile, EveryTruncationAndEveryExtraByteIsAnError) {
  auto bytes = exampleBytes();
  bytes.push_back(0);
  EXPECT_NE(problemOf(bytes), "");
  bytes.pop_back();
  while (!bytes.empty()) {
    bytes.pop_back();
    EXPECT_NE(problemOf(bytes), "") << "size " << bytes.size();
  }
}

TEST(PvsFile, SaysWhatIsWrong) {
  auto bytes = exampleBytes();
  bytes[8] = 9;
  EXPECT_NE(problemOf(bytes).find("version 9"), std::string::npos);
  bytes[8] = 2;
  EXPECT_NE(problemOf(bytes).find("version 2 of the format, this program reads 3 to 6"), std::string::npos);
  bytes[0] = 'P';
  EXPECT_NE(problemOf(bytes).find("not a .pvs file"), std::string::npos);
  for (const std::string text : {"", "v", "{}", "v 0 0 0\n", "v 0 0 0\nv 1 0 0\nv 1 1 0\n"}) {
    const std::string problem = problemOf({text.begin(), text.end()});
    EXPECT_NE(problem.find("not a .pvs file"), std::string::npos) << problem;
    EXPECT_EQ(problem.find("damaged"), std::string::npos) << problem;
  }
  EXPECT_NE(problemOf({0x89, 'S', 'L'}).find("damaged"), std::string::npos);
  TemporaryFolder folder;
  EXPECT_THROW(loadPvs(folder / "missing.pvs"), Error);
  EXPECT_THROW(loadPvs(folder.path()), Error);
}

TEST(PvsFile, RandomLiesWithRightChecksumsNeverCrash) {
  const auto good = exampleBytes();
  uint64_t head_size = 0;
  std::memcpy(&head_size, good.data() + 24, 8);
  TemporaryFolder folder;
  writeBytes(folder / "good.pvs", good);
  const size_t sections[] = {16, 16 + 16 + head_size + 8, bytesBeforeCosts(folder / "good.pvs").size()};
  std::mt19937 random(5);
  int accepted = 0;
  for (int round = 0; round < 3000; ++round) {
    auto bytes = good;
    const size_t section = sections[round % 3];
    uint64_t size = 0;
    std::memcpy(&size, good.data() + section + 8, 8);
    for (int k = 0; k < 1 + round % 4; ++k) {
      bytes[section + 16 + random() % size] = random() % 4 ? uint8_t(random()) : uint8_t(0xff);
    }
    fixChecksum(bytes, section);
    fixEnd(bytes);
    if (bytes == good) continue;
    if (problemOf(bytes) != "") continue;
    ++accepted;  // a lie within the rules: another seed, another time
    for (const CellPvs& cell : parsePvs(bytes, "y.pvs").cells) {
      EXPECT_TRUE(std::ranges::adjacent_find(cell.triangles, std::ranges::greater_equal()) ==
                  cell.triangles.end())
          << "seed 5, round " << round;
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, 3000);
}

TEST(PvsFile, RequiresItsScene) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{0, 1, 2}};
  PvsFile pvs;
  pvs.scene_name = "room.obj";
  pvs.triangle_count = 2;
  EXPECT_THROW(requireScene(pvs, scene, "x.pvs"), Error);
  pvs.triangle_count = 1;
  EXPECT_THROW(requireScene(pvs, scene, "x.pvs"), Error);
  pvs.scene_hash = hashScene(scene);
  EXPECT_NO_THROW(requireScene(pvs, scene, "x.pvs"));
}

TEST(SetCodec, PacksTheDocumentedExample) {
  const std::vector<uint32_t> ids = {0, 1, 2, 7, 300};
  const auto content = decompress(encodeSet(ids), 1000);
  ASSERT_TRUE(content);
  EXPECT_EQ(*content, (Bytes{0x00, 0x02, 0x04, 0x00, 0xa4, 0x02, 0x00}));
}

TEST(SetCodec, ComesBackForEveryDensityAndHighIds) {
  const unsigned seed = 11;
  std::mt19937 random(seed);
  for (double density : {0.0, 0.001, 0.1, 0.5, 0.9, 1.0}) {
    for (uint32_t first : {0u, (1u << 24) - 50u, 0xffffffffu - 3000u}) {
      std::vector<uint32_t> ids;
      for (uint32_t i = 0; i < 3000; ++i) {
        if (double(random()) < density * 0x1p32) ids.push_back(first + i);
      }
      const Bytes packed = encodeSet(ids);
      EXPECT_EQ(decodeSet(packed, ids.size(), 0xffffffffu), ids)
          << density << " " << first << " seed " << seed;
      EXPECT_FALSE(decodeSet(packed, ids.size() + 1, 0xffffffffu));
      const uint32_t below_last = ids.empty() ? 0 : ids.back();
      EXPECT_EQ(decodeSet(packed, ids.size(), below_last).has_value(), ids.empty());
    }
  }
}

TEST(SetCodec, RejectsRunsPastTheLimitAndOverlongIntegers) {
  EXPECT_FALSE(decodeSet(compress(Bytes{0, 0xff, 0xff, 0xff, 0xff, 0x0f}), 10, 0xffffffffu));
  EXPECT_FALSE(decodeSet(compress(Bytes{0xff, 0xff, 0xff, 0xff, 0x7f, 0}), 1, 0xffffffffu));
  EXPECT_FALSE(decodeSet(compress(Bytes{0x80, 0x80, 0x80, 0x80, 0x80, 0x00, 0}), 1, 0xffffffffu));
  EXPECT_FALSE(decodeSet(compress(Bytes{1}), 1, 10));
  EXPECT_FALSE(decodeSet(Bytes{1, 2, 3}, 1, 10));
  EXPECT_FALSE(decompress(compress(Bytes(100000, 7)), 99999));
  EXPECT_TRUE(decompress(compress(Bytes(100000, 7)), 100000));
}

}  // namespace
}  // namespace sightline
