#pragma once
#include <cstdint>

#include "core/base/error.h"

namespace sightline {

/// Which capacity the hash set has to begin with; it doubles as needed.
inline constexpr uint32_t kFirstHashCapacity = 1u << 16;

/// The largest there is: 2^31 slots of two words.
inline constexpr uint32_t kLargestHashCapacity = 1u << 31;

/// The capacity of a hash set `factor` times as large as one of `capacity` slots. Throws Error where there is
/// none.
inline uint32_t grownCapacity(uint32_t capacity, uint32_t factor) {
  const uint64_t grown = uint64_t(capacity) * factor;
  if (grown > kLargestHashCapacity) throw Error("the hash set of found triangles is full: use --set array");
  return static_cast<uint32_t>(grown);
}

}  // namespace sightline
