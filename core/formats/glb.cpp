#include "core/formats/glb.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <utility>

#include "core/base/error.h"

namespace sightline {
namespace {

uint32_t word(std::string_view bytes, size_t offset) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

/// The chunk whose header is at `offset`; moves the offset behind it.
std::pair<uint32_t, std::string_view> takeChunk(std::string_view bytes, size_t& offset,
                                                const std::string& name) {
  if (bytes.size() - offset < 8)
    throw Error(fmt::format("{}: chunk header cut off at byte {}", name, offset));
  const size_t length = word(bytes, offset);
  const uint32_t type = word(bytes, offset + 4);
  offset += 8;
  if (length > bytes.size() - offset) {
    throw Error(fmt::format("{}: chunk of {} bytes at byte {} is cut off after {}; is the file truncated?",
                            name, length, offset, bytes.size() - offset));
  }
  offset += length;
  return {type, bytes.substr(offset - length, length)};
}

}  // namespace

Glb splitGlb(std::string_view bytes, const std::string& name) {
  constexpr uint32_t kMagic = 0x46546c67;
  constexpr uint32_t kJson = 0x4e4f534a;
  constexpr uint32_t kBin = 0x004e4942;
  if (bytes.size() < 12 || word(bytes, 0) != kMagic) {
    throw Error(fmt::format("{}: is no GLB file: it does not start with \"glTF\" and a header", name));
  }
  if (word(bytes, 4) != 2)
    throw Error(fmt::format("{}: GLB version {}, only 2 is supported", name, word(bytes, 4)));
  const size_t length = word(bytes, 8);
  if (length > bytes.size() || length < 20) {
    throw Error(fmt::format("{}: the header says {} bytes, the file has {}; is it truncated?", name, length,
                            bytes.size()));
  }
  bytes = bytes.substr(0, length);
  size_t offset = 12;
  const auto [type, text] = takeChunk(bytes, offset, name);
  if (type != kJson) throw Error(fmt::format("{}: the first chunk is not JSON", name));
  Glb glb{text, {}};
  while (offset < bytes.size()) {
    const auto [next_type, next] = takeChunk(bytes, offset, name);
    if (next_type == kBin && glb.bin.data() == nullptr) glb.bin = next;
  }
  return glb;
}

}  // namespace sightline
