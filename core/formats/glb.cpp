// Based on: Khronos Group, glTF 2.0 Specification, 2021, chapter 4.
#include "core/formats/glb.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/formats/little_word.h"

namespace sightline {
namespace {

constexpr uint32_t kGlbMagic = 0x46546c67;
constexpr uint32_t kGlbJson = 0x4e4f534a;
constexpr uint32_t kGlbBin = 0x004e4942;
constexpr size_t kGlbHeaderBytes = 12, kGlbChunkHeaderBytes = 8;

/// The chunk whose header is at `offset`; moves the offset behind it.
std::pair<uint32_t, std::string_view> takeChunk(std::string_view bytes, size_t& offset,
                                                const std::string& name) {
  if (bytes.size() - offset < kGlbChunkHeaderBytes)
    throw Error(fmt::format("{}: chunk header cut off at byte {}", name, offset));
  const size_t length = littleWord(bytes, offset);
  const uint32_t type = littleWord(bytes, offset + 4);
  offset += kGlbChunkHeaderBytes;
  if (length > bytes.size() - offset) {
    throw Error(fmt::format("{}: chunk of {} bytes at byte {} is cut off after {}; is the file truncated?",
                            name, length, offset, bytes.size() - offset));
  }
  offset += length;
  return {type, bytes.substr(offset - length, length)};
}

}  // namespace

Glb splitGlb(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kGlbHeaderBytes || littleWord(bytes, 0) != kGlbMagic) {
    throw Error(fmt::format("{}: is no GLB file: it does not start with \"glTF\" and a header", name));
  }
  if (littleWord(bytes, 4) != 2) {
    throw Error(
        fmt::format("{}: GLB version {}, only 2 is supported; convert the file", name, littleWord(bytes, 4)));
  }
  const size_t length = littleWord(bytes, 8);
  Glb glb;
  if (length > bytes.size()) {
    throw Error(fmt::format("{}: the header says {} bytes, the file has {}; is it truncated?", name, length,
                            bytes.size()));
  }
  if (length < kGlbHeaderBytes + kGlbChunkHeaderBytes) {
    glb.warnings.push_back(fmt::format("the GLB header says {} bytes; all of the file's are read", length));
  } else {
    bytes = bytes.substr(0, length);
  }
  size_t offset = kGlbHeaderBytes;
  const auto [type, text] = takeChunk(bytes, offset, name);
  if (type != kGlbJson) throw Error(fmt::format("{}: the first chunk is not JSON", name));
  glb.json = text;
  std::string_view unmarked;
  while (offset < bytes.size()) {
    const auto [next_type, next] = takeChunk(bytes, offset, name);
    if (next_type == kGlbBin && glb.bin.data() == nullptr) glb.bin = next;
    if (next_type != kGlbBin && unmarked.data() == nullptr) unmarked = next;
  }
  if (glb.bin.data() == nullptr && unmarked.data() != nullptr) {
    glb.bin = unmarked;
    glb.warnings.emplace_back("no GLB chunk is marked as binary; the second is read as if it were");
  }
  return glb;
}

}  // namespace sightline
