// A reader written from docs/pvs-format.md alone; shares nothing with core/pvs but the values to compare.
#include <gtest/gtest.h>
#include <xxhash.h>
#include <zstd.h>

#include <cstring>

#include "tests/output/example_pvs.h"

namespace sightline {
namespace {

/// Takes values from the front of some bytes.
struct Cursor {
  const uint8_t* at;
  const uint8_t* end;

  const uint8_t* skip(size_t size) {
    EXPECT_LE(size, size_t(end - at));
    const uint8_t* begin = at;
    at += size;
    return begin;
  }
  template <typename T>
  T take() {
    T value;
    std::memcpy(&value, skip(sizeof(T)), sizeof(T));
    return value;
  }
  uint32_t u32() { return take<uint32_t>(); }
  uint64_t u64() { return take<uint64_t>(); }
  double f64() { return take<double>(); }
  std::string text() {
    const uint32_t size = u32();
    return std::string(reinterpret_cast<const char*>(skip(size)), size);
  }
};

/// Checks the section's frame and returns its payload.
Cursor section(Cursor& file, const char* kind) {
  const uint8_t* begin = file.at;
  EXPECT_EQ(std::memcmp(file.skip(4), kind, 4), 0) << kind;
  EXPECT_EQ(file.u32(), 0u);
  const uint64_t size = file.u64();
  const uint8_t* payload = file.skip(size);
  EXPECT_EQ(file.u64(), XXH3_64bits(begin, 16 + size));
  return {payload, payload + size};
}

std::vector<uint8_t> unzip(const uint8_t* frame, size_t size) {
  std::vector<uint8_t> content(1 << 16);
  content.resize(ZSTD_decompress(content.data(), content.size(), frame, size));
  return content;
}

uint32_t varint(Cursor& cursor) {
  uint32_t value = 0;
  for (int shift = 0;; shift += 7) {
    const auto byte = cursor.take<uint8_t>();
    value |= uint32_t(byte & 127) << shift;
    if (byte < 128) return value;
  }
}

std::vector<uint32_t> idsOf(const std::vector<uint8_t>& runs) {
  Cursor cursor{runs.data(), runs.data() + runs.size()};
  std::vector<uint32_t> ids;
  for (int64_t last = -1; cursor.at != cursor.end;) {
    int64_t id = last + 1 + varint(cursor);
    for (int64_t count = int64_t(varint(cursor)) + 1; count > 0; --count) ids.push_back(uint32_t(id++));
    last = id - 1;
  }
  return ids;
}

void checkHead(Cursor head, const PvsFile& want) {
  EXPECT_EQ(head.u64(), want.scene_hash);
  EXPECT_EQ(head.u32(), want.triangle_count);
  EXPECT_EQ(head.u32(), 1u);
  EXPECT_EQ(head.u32(), want.algorithm);
  const BakeParams& p = want.params;
  EXPECT_EQ(head.u32(), uint32_t(p.method));
  for (uint32_t value : {p.n_rand, p.n_abs_edge, p.n_rs_edge, p.n_rs_area}) EXPECT_EQ(head.u32(), value);
  for (float value : {p.delta_abs_relative, p.delta_abs, p.delta_rs_relative, p.delta_rs}) {
    EXPECT_EQ(head.take<float>(), value);
  }
  for (uint32_t value : {p.threshold, p.quiet_iterations, p.batch_rays}) EXPECT_EQ(head.u32(), value);
  for (uint64_t value : {p.max_rays, p.validation_rays, p.seed}) EXPECT_EQ(head.u64(), value);
  EXPECT_EQ(head.f64(), p.max_seconds);
  EXPECT_EQ(head.u32(), p.raster_resolution);
  EXPECT_EQ(head.f64(), p.target_error);
  EXPECT_EQ(head.take<float>(), p.abs_spacing);
  EXPECT_EQ(head.u32(), p.reverse_stride);
  EXPECT_EQ(head.u32(), uint32_t(p.order));
  EXPECT_EQ(head.text(), want.scene_name);
  EXPECT_EQ(head.text(), want.intersector);
  ASSERT_EQ(head.u32(), want.planned.size());
  for (const ViewCell& cell : want.planned) {
    EXPECT_EQ(head.text(), cell.name);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(head.f64(), cell.center[axis]);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(head.f64(), cell.size[axis]);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(head.f64(), cell.rotation[axis]);
  }
  EXPECT_EQ(head.at, head.end);
}

void checkStats(Cursor& cell, const CellStats& want) {
  for (const StageStats& stage : {want.random, want.border, want.reverse}) {
    EXPECT_EQ(cell.u64(), stage.rays);
    EXPECT_EQ(cell.u64(), stage.new_triangles);
  }
  EXPECT_EQ(cell.u64(), want.contained_triangles);
  EXPECT_EQ(cell.u32(), want.iterations);
  EXPECT_EQ(cell.u32(), uint32_t(want.stop));
  for (uint64_t value : {want.validation_rays, want.missing_rays, want.bound_rays}) {
    EXPECT_EQ(cell.u64(), value);
  }
  EXPECT_EQ(cell.u32(), want.bound_tests);
  EXPECT_EQ(cell.f64(), want.error_bound);
}

void checkCost(Cursor& cost, uint32_t index, const CellPvs& want) {
  EXPECT_EQ(cost.u32(), index);
  for (const StageStats& stage : {want.stats.random, want.stats.border, want.stats.reverse}) {
    EXPECT_EQ(cost.f64(), stage.seconds);
  }
  EXPECT_EQ(cost.f64(), want.stats.seconds);
  EXPECT_EQ(cost.u64(), want.stats.peak_device_bytes);
  EXPECT_EQ(cost.text(), want.device);
}

void checkWitnesses(const std::vector<uint8_t>& content, const std::vector<Witness>& want) {
  ASSERT_EQ(content.size(), want.size() * 25);
  Cursor cursor{content.data(), content.data() + content.size()};
  for (const Witness& w : want) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(cursor.take<float>(), w.origin[axis]);
  }
  for (const Witness& w : want) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(cursor.take<float>(), w.direction[axis]);
  }
  for (const Witness& w : want) EXPECT_EQ(cursor.take<uint8_t>(), w.stage);
}

void checkCell(Cursor cell, uint32_t index, const CellPvs& want) {
  EXPECT_EQ(cell.u32(), index);
  EXPECT_EQ(cell.u32(), want.triangles.size());
  checkStats(cell, want.stats);
  const uint64_t set_size = cell.u64();
  const uint8_t* set = cell.skip(set_size);
  EXPECT_EQ(idsOf(unzip(set, set_size)), want.triangles);
  if (want.triangles.empty()) {
    EXPECT_EQ(cell.at, cell.end);
  } else {
    checkWitnesses(unzip(cell.at, size_t(cell.end - cell.at)), want.witnesses);
  }
}

TEST(PvsFormat, AReaderWrittenFromTheDocumentReadsAFile) {
  TemporaryFolder folder;
  const PvsFile want = examplePvs();
  savePvs(want, folder / "x.pvs");
  const auto bytes = readBytes(folder / "x.pvs");
  Cursor file{bytes.data(), bytes.data() + bytes.size()};
  const uint8_t prelude[16] = {0x89, 0x53, 0x4c, 0x50, 0x56, 0x53, 0x0d, 0x0a, 4};
  EXPECT_EQ(std::memcmp(file.skip(16), prelude, 16), 0);
  checkHead(section(file, "HEAD"), want);
  for (uint32_t i = 0; i < want.cells.size(); ++i) checkCell(section(file, "CELL"), i, want.cells[i]);
  Cursor costs = section(file, "COST");
  for (uint32_t i = 0; i < want.cells.size(); ++i) checkCost(costs, i, want.cells[i]);
  EXPECT_EQ(costs.at, costs.end);
  const auto before_end = size_t(file.at - bytes.data());
  Cursor end = section(file, "END ");
  EXPECT_EQ(end.u32(), want.cells.size());
  EXPECT_EQ(end.u32(), 0u);
  EXPECT_EQ(end.u64(), XXH3_64bits(bytes.data(), before_end));
  EXPECT_EQ(end.at, end.end);
  EXPECT_EQ(file.at, file.end);
}

}  // namespace
}  // namespace sightline
