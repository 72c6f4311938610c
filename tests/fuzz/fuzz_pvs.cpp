#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"
#include "tests/fuzz/check.h"

namespace sightline::fuzz {
namespace {

const std::string kName = "a.pvs";

/// Sets are as large as the scene that the file says it is of, however small the file: what such a scene
/// takes is no finding.
constexpr uint32_t kLargestScene = 1 << 16;

/// The triangles of the scene that the file claims: the second number of its head.
uint32_t claimedTriangles(const uint8_t* data, size_t size) {
  constexpr size_t kAt = kPvsPreludeBytes + kSectionHeadBytes + sizeof(uint64_t);
  uint32_t triangles = 0;
  if (size >= kAt + sizeof triangles) std::memcpy(&triangles, data + kAt, sizeof triangles);
  return triangles;
}

Bytes written(const PvsFile& pvs) {
  Bytes all;
  writePvs(pvs, [&](const Bytes& bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); });
  return all;
}

/// What pvs.h promises of a file that was read.
void requireInvariants(const PvsFile& pvs) {
  require(pvs.version >= kOldestPvsVersion && pvs.version <= kPvsVersion, "an unknown version");
  require(!pvs.planned.empty() && pvs.cells.size() <= pvs.planned.size(), "more cells than planned");
  for (size_t i = 0; i < pvs.cells.size(); ++i) {
    const CellPvs& cell = pvs.cells[i];
    require(cell.cell == pvs.planned[i], "another cell than planned");
    require(std::adjacent_find(cell.triangles.begin(), cell.triangles.end(), std::greater_equal<>()) ==
                cell.triangles.end(),
            "ids that do not ascend");
    require(cell.triangles.empty() || cell.triangles.back() < pvs.triangle_count, "an id out of range");
    require(cell.witnesses.size() == (pvs.has_witnesses ? cell.triangles.size() : 0), "witnesses missing");
    require(cell.open.has_value() != pvs.doors.empty(), "an open set without doors, or none with them");
    if (cell.open) {
      const std::vector<uint32_t>& added = cell.open->triangles;
      require(std::adjacent_find(added.begin(), added.end(), std::greater_equal<>()) == added.end(),
              "added ids that do not ascend");
      require(added.empty() || added.back() < pvs.triangle_count, "an added id out of range");
      require(cell.open->witnesses.size() == (pvs.has_witnesses ? added.size() : 0),
              "open witnesses missing");
    }
    for (const CellCost& cost : {costOf(cell, 0)}) {
      for (const double seconds :
           {cost.random_seconds, cost.border_seconds, cost.reverse_seconds, cost.seconds}) {
        require(seconds >= 0, "a negative time");
      }
    }
  }
}

void requireRoundTrip(const PvsFile& pvs) {
  const Bytes once = written(pvs);
  const PvsFile again = parsePvs(once, kName);
  require(again.cells.size() == pvs.cells.size() && again.planned == pvs.planned, "other cells");
  for (size_t i = 0; i < pvs.cells.size(); ++i) {
    require(again.cells[i].triangles == pvs.cells[i].triangles, "another set");
    require(!pvs.cells[i].open || again.cells[i].open->triangles == pvs.cells[i].open->triangles,
            "another open set");
  }
  require(written(again) == once, "other bytes after reading and writing");
}

void checkWhole(const Bytes& bytes) {
  expectLine(kName, [&] {
    PvsFile pvs;
    try {
      pvs = parsePvs(bytes, kName);
    } catch (const BadPvs&) {
      throw;
    } catch (const Error& error) {
      require(false, fmt::format("damage that is no BadPvs: {}", error.what()));
    }
    requireInvariants(pvs);
    requireRoundTrip(pvs);
  });
}

/// The same bytes as what a bake that was cut off left.
void checkPartial(const Bytes& bytes) {
  expectLine(kName, [&] {
    const PartialPvs left = parsePartialPvs(bytes, kName);
    require(left.whole_bytes + left.torn_bytes == bytes.size(), "bytes that are neither whole nor torn");
    if (left.whole_bytes == 0) {
      require(left.places.empty() && left.pvs.cells.empty(), "cells of a file that is not sound");
      return;
    }
    requireInvariants(left.pvs);
    require(left.places.size() == left.pvs.cells.size() + 1, "cells without place");
    for (const ByteRange& place : left.places) {
      require(place.offset <= left.whole_bytes && place.size <= left.whole_bytes - place.offset,
              "a place beyond what is whole");
    }
    requireRoundTrip(left.pvs);
  });
}

}  // namespace
}  // namespace sightline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace sightline::fuzz;
  if (claimedTriangles(data, size) > kLargestScene) return -1;
  const sightline::Bytes bytes(data, data + size);
  checkWhole(bytes);
  checkPartial(bytes);
  return 0;
}
