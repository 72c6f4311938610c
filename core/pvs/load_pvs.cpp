#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/io/file_io.h"
#include "core/pvs/pvs_file.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"

namespace sightline {
namespace {

Bytes readBytes(const std::filesystem::path& file) {
  const FileBytes content = readFile(file);
  return Bytes(content.data.get(), content.data.get() + content.size);
}

[[noreturn]] void failAt(const std::filesystem::path& file, uint64_t offset, const std::string& problem) {
  throw BadPvs(
      fmt::format("{}: byte {}: {}; the file is damaged, bake again", file.string(), offset, problem));
}

/// Whether the bytes begin as those of every .pvs file do, as far as they go.
bool beginsAsPvs(const Bytes& bytes) {
  const size_t there = std::min(bytes.size(), sizeof(kPvsMagic));
  return std::equal(bytes.begin(), bytes.begin() + ptrdiff_t(there), std::begin(kPvsMagic));
}

/// Returns the version of the format.
uint32_t readPrelude(const Bytes& bytes, const std::filesystem::path& file) {
  if (bytes.empty()) throw BadPvs(fmt::format("{}: is empty, not a .pvs file", file.string()));
  if (!beginsAsPvs(bytes)) {
    throw BadPvs(fmt::format("{}: not a .pvs file (its first bytes are not those of one)", file.string()));
  }
  if (bytes.size() < kPvsPreludeBytes) failAt(file, bytes.size(), "cut off in the first 16 bytes");
  ByteReader in{std::span(bytes).subspan(sizeof(kPvsMagic))};
  const auto version = in.number<uint32_t>();
  if (version < kOldestPvsVersion || version > kPvsVersion) {
    throw BadPvs(fmt::format("{}: has version {} of the format, this program reads {} to {}; bake again",
                             file.string(), version, kOldestPvsVersion, kPvsVersion));
  }
  if (in.number<uint32_t>() != 0) failAt(file, 12, "four zero bytes expected");
  return version;
}

/// Reads the head into `pvs` and returns its end.
uint64_t readHead(const Bytes& bytes, uint32_t version, PvsFile& pvs) {
  const Section section = readSection(bytes, kPvsPreludeBytes);
  if (section.kind != kSectionHead) throw Damage("the first section must be HEAD");
  pvs = readHeadPayload(section.payload, version);
  return section.end;
}

bool isComplete(const Section& section) {
  return section.kind == kSectionEnd;
}

/// Cells and what they took, in whatever order their sections come.
class CellSections {
 public:
  explicit CellSections(const PvsFile& head) : head_(head) {}

  /// Takes a CELL or COST section. Throws Damage.
  void add(const Section& section) {
    if (section.kind == kSectionCell) {
      addCell(section);
    } else if (section.kind == kSectionCost) {
      for (CellCost& cost : readCostPayload(section.payload, head_)) addCost(std::move(cost));
    } else {
      throw Damage("section of unknown kind");
    }
  }

  /// Whether the cells are the first of those planned, and it is known what each took.
  bool whole() const { return areFirst(cells_) && areFirst(costs_) && cells_.size() == costs_.size(); }
  size_t size() const { return cells_.size(); }

  /// Moves the first cells, which must be whole, to pvs.cells and their places to `places`.
  void take(size_t count, PvsFile& pvs, std::vector<ByteRange>& places) {
    for (uint32_t index = 0; index < count; ++index) {
      PlacedCell& cell = cells_.at(index);
      setCost(cell.pvs, costs_.at(index));
      pvs.cells.push_back(std::move(cell.pvs));
      places.push_back(cell.place);
    }
    if (count != 0) pvs.device = pvs.cells.front().device;
  }

 private:
  struct PlacedCell {
    CellPvs pvs;
    ByteRange place;
  };

  template <typename T>
  static bool areFirst(const std::map<uint32_t, T>& by_index) {
    return by_index.empty() || by_index.rbegin()->first + 1 == by_index.size();
  }

  void addCell(const Section& section) {
    IndexedCell cell = readCellPayload(section.payload, head_);
    if (head_.version < kPvsVersionWithCosts) {  // has the cost among the counts, and one device for all
      cell.pvs.device = head_.device;
      addCost(costOf(cell.pvs, cell.index));
    }
    const ByteRange place{section.offset, section.end - section.offset};
    if (!cells_.emplace(cell.index, PlacedCell{std::move(cell.pvs), place}).second) {
      throw Damage("a cell comes twice");
    }
  }

  void addCost(CellCost cost) {
    const uint32_t index = cost.index;
    if (!costs_.emplace(index, std::move(cost)).second) throw Damage("the times of a cell come twice");
  }

  const PvsFile& head_;
  std::map<uint32_t, PlacedCell> cells_;
  std::map<uint32_t, CellCost> costs_;
};

}  // namespace

PvsFile parsePvs(const Bytes& bytes, const std::filesystem::path& file) {
  const uint32_t version = readPrelude(bytes, file);
  PvsFile pvs;
  uint64_t offset = kPvsPreludeBytes;
  try {
    offset = readHead(bytes, version, pvs);
    CellSections cells(pvs);
    Section section = readSection(bytes, offset);
    for (; !isComplete(section); section = readSection(bytes, offset)) {
      cells.add(section);
      offset = section.end;
    }
    checkEndPayload(section.payload, uint32_t(cells.size()), XXH3_64bits(bytes.data(), offset));
    if (!cells.whole()) throw Damage("a cell or its times are missing before it");
    offset = section.end;
    if (offset != bytes.size()) throw Damage("bytes after the end");
    std::vector<ByteRange> places;
    cells.take(cells.size(), pvs, places);
  } catch (const Damage& damage) {
    failAt(file, offset, damage.what());
  }
  return pvs;
}

PvsFile loadPvs(const std::filesystem::path& file) {
  return parsePvs(readBytes(file), file);
}

PartialPvs loadPartialPvs(const std::filesystem::path& part) {
  return parsePartialPvs(readBytes(part), part);
}

PartialPvs parsePartialPvs(const Bytes& bytes, const std::filesystem::path& part) {
  PartialPvs left;
  if (bytes.size() < kPvsPreludeBytes && beginsAsPvs(bytes)) {  // killed before all of it was there
    left.torn_bytes = bytes.size();
    if (!bytes.empty()) left.problem = "cut off in its head";
    return left;
  }
  const uint32_t version = readPrelude(bytes, part);
  CellSections cells(left.pvs);
  size_t whole_cells = 0;
  try {
    uint64_t offset = left.whole_bytes = readHead(bytes, version, left.pvs);
    left.places.push_back({0, offset});
    while (offset < bytes.size()) {
      const Section section = readSection(bytes, offset);
      if (isComplete(section)) break;  // killed between the end and the rename: finish again
      cells.add(section);
      offset = section.end;
      if (!cells.whole()) continue;
      left.whole_bytes = offset;
      whole_cells = cells.size();
    }
  } catch (const Damage& damage) {
    left.problem = damage.what();
  }
  cells.take(whole_cells, left.pvs, left.places);
  left.torn_bytes = bytes.size() - left.whole_bytes;
  return left;
}

PvsFile loadFinishedCells(const std::filesystem::path& file) {
  if (file.extension() != ".part") return loadPvs(file);
  PartialPvs left = loadPartialPvs(file);
  if (left.whole_bytes == 0) {
    throw BadPvs(fmt::format("{}: holds no bake yet: {}", file.string(),
                             left.problem.empty() ? "the file is empty" : left.problem));
  }
  return std::move(left.pvs);
}

}  // namespace sightline
