#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>

#include "core/io/byte_stream.h"
#include "core/pvs/pvs_file.h"

// The parts of a .pvs file as docs/pvs-format.md specifies them.
namespace sightline {

inline constexpr uint8_t kPvsMagic[8] = {0x89, 'S', 'L', 'P', 'V', 'S', '\r', '\n'};
/// The oldest version of the format that is still read.
inline constexpr uint32_t kOldestPvsVersion = 3;
/// The first version with an algorithm's revision, an intersector and COST sections.
inline constexpr uint32_t kPvsVersionWithCosts = 4;

/// The first version with a smallest hole, doors and objects that hide nothing.
inline constexpr uint32_t kPvsVersionWithDoors = 5;

/// The first version with a bound.
inline constexpr uint32_t kPvsVersionWithBound = 6;

/// Bytes before the first section.
inline constexpr size_t kPvsPreludeBytes = 16;
/// Bytes of a section before its payload, and after it.
inline constexpr size_t kSectionHeadBytes = 16;
inline constexpr size_t kSectionChecksumBytes = 8;

/// Kinds of sections, four letters each.
inline constexpr uint32_t kSectionHead = 0x44414548;  // "HEAD"
inline constexpr uint32_t kSectionCell = 0x4c4c4543;  // "CELL"
inline constexpr uint32_t kSectionCost = 0x54534f43;  // "COST"
inline constexpr uint32_t kSectionEnd = 0x20444e45;   // "END "

/// What is wrong with bytes of a file, without file and place.
class Damage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A part of a file.
struct Section {
  uint32_t kind = 0;
  std::span<const uint8_t> payload;
  uint64_t offset = 0;  ///< of its first byte in the file
  uint64_t end = 0;     ///< of the byte after it
};

/// Throws Damage if the file's bytes have no sound section at `offset`, which is not beyond their end.
Section readSection(std::span<const uint8_t> bytes, uint64_t offset);

/// A cell and its index among the planned ones.
struct IndexedCell {
  uint32_t index = 0;
  CellPvs pvs;
};

/// What a cell took: all that may differ between two equal bakes.
struct CellCost {
  uint32_t index = 0;  ///< among the planned ones
  double random_seconds = 0, border_seconds = 0, reverse_seconds = 0;
  double seconds = 0;
  double open_seconds = 0;  ///< of the open set; in files with doors only
  uint64_t peak_device_bytes = 0;
  std::string device;
};

CellCost costOf(const CellPvs& cell, uint32_t index);
void setCost(CellPvs& cell, const CellCost& cost);

/// Magic, version, 0.
Bytes writePrelude(std::span<const uint8_t, sizeof(kPvsMagic)> magic, uint32_t version);
/// Kind, size, payload and checksum.
Bytes writeSection(uint32_t kind, std::span<const uint8_t> payload);

Bytes writeHeadPayload(const PvsFile& pvs);
/// The cell without its cost. Throws Error, an error of this program, if its witnesses are not one a triangle
/// or none, or its open set is not there or there, as `head` says.
Bytes writeCellPayload(const CellPvs& cell, uint32_t index, const PvsFile& head);
/// Part of a COST section's payload, which is one or more of these.
void writeCost(ByteWriter& out, const CellCost& cost, const PvsFile& head);
/// checksum: XXH3 of all bytes of the file before the section.
Bytes writeEndPayload(uint32_t cells, uint64_t checksum);

/// The four readers throw Damage. version: of the format.
PvsFile readHeadPayload(std::span<const uint8_t> payload, uint32_t version);
/// head: for planned cells, the limit of ids and the version. In version 3 the cell's cost is in it.
IndexedCell readCellPayload(std::span<const uint8_t> payload, const PvsFile& head);
std::vector<CellCost> readCostPayload(std::span<const uint8_t> payload, const PvsFile& head);
void checkEndPayload(std::span<const uint8_t> payload, uint32_t cells, uint64_t checksum);

/// A whole file, handed to `put` section by section: each pvs.cells with its device. Throws Error.
void writePvs(const PvsFile& pvs, const std::function<void(const Bytes&)>& put);

/// A whole file in memory; `file` is for messages. Throws BadPvs.
PvsFile parsePvs(const Bytes& bytes, const std::filesystem::path& file);

}  // namespace sightline
