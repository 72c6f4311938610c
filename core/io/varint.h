#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "core/io/byte_stream.h"

namespace sightline {

/// Bytes of the longest variable-length 32-bit integer: 7 bits a byte.
inline constexpr uint64_t kMaxVarintBytes = 5;

inline void appendVarint(Bytes& bytes, uint32_t value) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(uint8_t(value | 0x80));
  bytes.push_back(uint8_t(value));
}

/// Nothing at the end of the bytes or when the value does not fit 32 bits.
inline std::optional<uint32_t> readVarint(std::span<const uint8_t> bytes, size_t& at) {
  uint64_t value = 0;
  for (uint64_t i = 0; i < kMaxVarintBytes && at < bytes.size(); ++i) {
    const uint8_t byte = bytes[at++];
    value |= uint64_t(byte & 0x7f) << (7 * i);
    if (byte < 0x80) return value > 0xffffffffu ? std::nullopt : std::optional(uint32_t(value));
  }
  return std::nullopt;
}

}  // namespace sightline
