#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"
#include "tests/fuzz/check.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace sightline::fuzz {
namespace {

const std::string kName = "a.pvs";

/// Sets are as large as the scene that the file says it is of, however small the file: what such a scene
/// takes is no finding.
constexpr uint32_t kLargestScene = 1 << 16;

template <typename T>
T numberAt(const uint8_t* data) {
  T value;
  std::memcpy(&value, data, sizeof value);
  return value;
}

/// The triangles of the scene that the file claims: the second number of its head.
uint32_t claimedTriangles(const uint8_t* data, size_t size) {
  constexpr size_t kAt = kPvsPreludeBytes + kSectionHeadBytes + sizeof(uint64_t);
  return size < kAt + sizeof(uint32_t) ? 0 : numberAt<uint32_t>(data + kAt);
}

/// A section as docs/pvs-format.md has it, checksum and all.
struct Place {
  size_t at = 0;
  size_t payload = 0;
  size_t end() const { return at + kSectionHeadBytes + payload + kSectionChecksumBytes; }
};

/// The sections of a file, up to the first that is cut off.
std::vector<Place> sectionsOf(const uint8_t* data, size_t size) {
  std::vector<Place> places;
  for (size_t at = kPvsPreludeBytes; at < size && size - at >= kSectionHeadBytes + kSectionChecksumBytes;) {
    const auto payload = numberAt<uint64_t>(data + at + 8);
    if (payload > size - at - kSectionHeadBytes - kSectionChecksumBytes) break;
    places.push_back({at, size_t(payload)});
    at = places.back().end();
  }
  return places;
}

/// Puts the checksums right as far as there are sections, else changes would never reach what is behind them.
void mendChecksums(uint8_t* data, size_t size) {
  for (const Place& section : sectionsOf(data, size)) {
    uint8_t* payload = data + section.at + kSectionHeadBytes;
    if (numberAt<uint32_t>(data + section.at) == kSectionEnd && section.payload == 16) {
      const uint64_t all = XXH3_64bits(data, section.at);
      std::memcpy(payload + 8, &all, sizeof all);
    }
    const uint64_t checksum = XXH3_64bits(data + section.at, kSectionHeadBytes + section.payload);
    std::memcpy(payload + section.payload, &checksum, sizeof checksum);
  }
}

/// Changes the payload of one section, and its size with it; returns the file's size.
size_t mutateSection(uint8_t* data, size_t size, size_t max_size, const Place& section) {
  const Bytes rest(data + section.at + kSectionHeadBytes + section.payload, data + size);
  uint8_t* payload = data + section.at + kSectionHeadBytes;
  const uint64_t mutated = LLVMFuzzerMutate(payload, section.payload, section.payload + (max_size - size));
  std::memcpy(data + section.at + 8, &mutated, sizeof mutated);
  std::copy(rest.begin(), rest.end(), payload + mutated);
  return size - section.payload + size_t(mutated);
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

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed) {
  using namespace sightline::fuzz;
  std::minstd_rand random(seed);
  const std::vector<Place> sections = sectionsOf(data, size);
  const bool anywhere = sections.empty() || size > max_size || random() % 4 == 0;
  size = anywhere ? LLVMFuzzerMutate(data, size, max_size)
                  : mutateSection(data, size, max_size, sections[random() % sections.size()]);
  constexpr unsigned kLeftWrong = 16;  // one of so many keeps its wrong checksums
  if (random() % kLeftWrong != 0) mendChecksums(data, size);
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace sightline::fuzz;
  if (claimedTriangles(data, size) > kLargestScene) return -1;
  const sightline::Bytes bytes(data, data + size);
  checkWhole(bytes);
  checkPartial(bytes);
  return 0;
}
