#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <random>

#include "core/error.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"
#include "core/pvs/set_codec.h"
#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

void expectEqual(const CellPvs& got, const CellPvs& want) {
  EXPECT_EQ(got.cell.name, want.cell.name);
  EXPECT_EQ(got.cell.center, want.cell.center);
  EXPECT_EQ(got.cell.size, want.cell.size);
  EXPECT_EQ(got.cell.rotation, want.cell.rotation);
  EXPECT_EQ(got.triangles, want.triangles);
  EXPECT_EQ(writeCellPayload(got, 0), writeCellPayload(want, 0));  // statistics
  ASSERT_EQ(got.witnesses.size(), want.witnesses.size());
  for (size_t i = 0; i < want.witnesses.size(); ++i) {
    EXPECT_EQ(got.witnesses[i].origin, want.witnesses[i].origin) << i;
    EXPECT_EQ(got.witnesses[i].direction, want.witnesses[i].direction) << i;
    EXPECT_EQ(got.witnesses[i].stage, want.witnesses[i].stage) << i;
  }
}

void expectEqual(const PvsFile& got, const PvsFile& want) {
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
  bytes[0] = 'P';
  EXPECT_NE(problemOf(bytes).find("not a .pvs file"), std::string::npos);
  TemporaryFolder folder;
  EXPECT_THROW(loadPvs(folder / "missing.pvs"), Error);
  EXPECT_THROW(loadPvs(folder.path()), Error);
}

TEST(PvsFile, RandomLiesWithRightChecksumsNeverCrash) {
  const auto good = exampleBytes();
  uint64_t head_size = 0;
  std::memcpy(&head_size, good.data() + 24, 8);
  const size_t cell_section = 16 + 16 + head_size + 8;
  std::mt19937 random(5);
  int accepted = 0;
  for (int round = 0; round < 3000; ++round) {
    auto bytes = good;
    const size_t section = round % 2 ? 16 : cell_section;
    uint64_t size = 0;
    std::memcpy(&size, good.data() + section + 8, 8);
    for (int k = 0; k < 1 + round % 3; ++k) {
      bytes[section + 16 + random() % size] = random() % 4 ? uint8_t(random()) : uint8_t(0xff);
    }
    fixChecksum(bytes, section);
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
