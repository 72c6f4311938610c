#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "core/pvs/byte_stream.h"
#include "core/pvs/pvs.h"

// The parts of a .pvs file as docs/pvs-format.md specifies them.
namespace sightline {

inline constexpr uint8_t kPvsMagic[8] = {0x89, 'S', 'L', 'P', 'V', 'S', '\r', '\n'};
inline constexpr uint32_t kPvsVersion = 3;

/// Bytes before the first section.
inline constexpr size_t kPvsPreludeBytes = 16;
/// Bytes of a section before its payload, and after it.
inline constexpr size_t kSectionHeadBytes = 16;
inline constexpr size_t kSectionChecksumBytes = 8;

/// Kinds of sections, four letters each.
inline constexpr uint32_t kSectionHead = 0x44414548;  // "HEAD"
inline constexpr uint32_t kSectionCell = 0x4c4c4543;  // "CELL"
inline constexpr uint32_t kSectionEnd = 0x20444e45;   // "END "

/// Magic, version, 0.
Bytes writePrelude();
/// Kind, size, payload and checksum.
Bytes writeSection(uint32_t kind, std::span<const uint8_t> payload);

Bytes writeHeadPayload(const PvsFile& pvs);
Bytes writeCellPayload(const CellPvs& cell, uint32_t index);
/// checksum: XXH3 of all bytes of the file before the section.
Bytes writeEndPayload(uint32_t cells, uint64_t checksum);

/// The three readers throw std::string: what is wrong, without file and place.
PvsFile readHeadPayload(std::span<const uint8_t> payload);
/// head: for planned cells and the limit of ids; index: that the section must have.
CellPvs readCellPayload(std::span<const uint8_t> payload, const PvsFile& head, uint32_t index);
void checkEndPayload(std::span<const uint8_t> payload, uint32_t cells, uint64_t checksum);

/// A whole file in memory; `file` is for messages. Throws Error.
PvsFile parsePvs(const Bytes& bytes, const std::filesystem::path& file);

}  // namespace sightline
