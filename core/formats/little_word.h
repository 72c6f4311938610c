#pragma once
#include <cstdint>
#include <cstring>
#include <string_view>

namespace sightline {

/// The 32-bit number, little endian, at that place; four bytes must be there.
inline uint32_t littleWord(std::string_view bytes, size_t offset) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

}  // namespace sightline
