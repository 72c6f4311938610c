#include "core/pvs/pvs.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>

#include "core/error.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"
#include "core/scene/file_io.h"

namespace sightline {
namespace {

struct Section {
  uint32_t kind = 0;
  std::span<const uint8_t> payload;
  uint64_t offset = 0;  ///< of its first byte in the file
  uint64_t end = 0;     ///< of the byte after it
};

Bytes readBytes(const std::filesystem::path& file) {
  const FileBytes content = readFile(file);
  return Bytes(content.data.get(), content.data.get() + content.size);
}

[[noreturn]] void failAt(const std::filesystem::path& file, uint64_t offset, const std::string& problem) {
  throw Error(
      fmt::format("{}: byte {}: {}; the file is damaged, bake again", file.string(), offset, problem));
}

void checkPrelude(const Bytes& bytes, const std::filesystem::path& file) {
  const Bytes expected = writePrelude();
  if (bytes.size() < expected.size()) failAt(file, bytes.size(), "cut off in the first 16 bytes");
  if (!std::equal(std::begin(kPvsMagic), std::end(kPvsMagic), bytes.begin())) {
    throw Error(fmt::format("{}: not a .pvs file (its first 8 bytes differ)", file.string()));
  }
  ByteReader in{std::span(bytes).subspan(sizeof(kPvsMagic))};
  const auto version = in.number<uint32_t>();
  if (version != kPvsVersion) {
    throw Error(fmt::format("{}: has version {} of the format, this program reads version {}; bake again",
                            file.string(), version, kPvsVersion));
  }
  if (in.number<uint32_t>() != 0) failAt(file, 12, "four zero bytes expected");
}

/// Throws std::string if there is no sound section at `offset`.
Section readSection(const Bytes& bytes, uint64_t offset) {
  ByteReader in{std::span(bytes).subspan(size_t(offset))};
  Section section{in.number<uint32_t>(), {}, offset, 0};
  const auto reserved = in.number<uint32_t>();
  const auto size = in.number<uint64_t>();
  if (in.failed()) throw std::string("cut off in the head of a section");
  section.payload = in.raw(size);
  const auto checksum = in.number<uint64_t>();
  if (in.failed()) throw std::string("cut off in a section");
  section.end = offset + kSectionHeadBytes + size + kSectionChecksumBytes;
  if (checksum != XXH3_64bits(bytes.data() + offset, kSectionHeadBytes + size) || reserved != 0) {
    throw std::string("checksum of a section differs");
  }
  return section;
}

/// Reads the head into `pvs` and returns its end.
uint64_t readHead(const Bytes& bytes, PvsFile& pvs) {
  const Section section = readSection(bytes, kPvsPreludeBytes);
  if (section.kind != kSectionHead) throw std::string("the first section must be HEAD");
  pvs = readHeadPayload(section.payload);
  return section.end;
}

bool isComplete(const Section& section) {
  return section.kind == kSectionEnd;
}

/// Appends the section's cell to pvs.cells.
void readCell(const Section& section, PvsFile& pvs) {
  if (section.kind != kSectionCell) throw std::string("section of unknown kind");
  pvs.cells.push_back(readCellPayload(section.payload, pvs, uint32_t(pvs.cells.size())));
}

}  // namespace

PvsFile parsePvs(const Bytes& bytes, const std::filesystem::path& file) {
  checkPrelude(bytes, file);
  PvsFile pvs;
  uint64_t offset = kPvsPreludeBytes;
  try {
    offset = readHead(bytes, pvs);
    Section section = readSection(bytes, offset);
    for (; !isComplete(section); section = readSection(bytes, offset)) {
      readCell(section, pvs);
      offset = section.end;
    }
    checkEndPayload(section.payload, uint32_t(pvs.cells.size()), XXH3_64bits(bytes.data(), offset));
    offset = section.end;
    if (offset != bytes.size()) throw std::string("bytes after the end");
  } catch (const std::string& problem) {
    failAt(file, offset, problem);
  }
  return pvs;
}

PvsFile loadPvs(const std::filesystem::path& file) {
  return parsePvs(readBytes(file), file);
}

PartialPvs loadPartialPvs(const std::filesystem::path& part) {
  const Bytes bytes = readBytes(part);
  PartialPvs left;
  if (bytes.size() >= kPvsPreludeBytes) checkPrelude(bytes, part);
  try {
    left.whole_bytes = bytes.size() < kPvsPreludeBytes ? 0 : readHead(bytes, left.pvs);
    while (left.whole_bytes != 0 && left.whole_bytes < bytes.size()) {
      const Section section = readSection(bytes, left.whole_bytes);
      if (isComplete(section)) break;  // killed between the end and the rename: finish again
      readCell(section, left.pvs);
      left.whole_bytes = section.end;
    }
    if (left.whole_bytes == 0 && !bytes.empty()) left.problem = "cut off in its head";
  } catch (const std::string& problem) {
    left.problem = problem;
  }
  left.torn_bytes = bytes.size() - left.whole_bytes;
  return left;
}

PvsFile loadFinishedCells(const std::filesystem::path& file) {
  return file.extension() == ".part" ? loadPartialPvs(file).pvs : loadPvs(file);
}

void savePvs(const PvsFile& pvs, const std::filesystem::path& file) {
  requireReplaceable(file);
  auto temporary = file;
  temporary += ".tmp";
  try {
    PvsWriter writer(temporary);
    writer.begin(pvs);
    for (const CellPvs& cell : pvs.cells) writer.append(cell);
    writer.finish(file);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

}  // namespace sightline
