#pragma once
#include <cstdint>

#include "core/base/splitmix.h"

namespace sightline {

/// Small generator for scene layout: splitmix64. The distributions of <random> differ between standard
/// libraries, these do not. Draw one number a statement or a declarator: in which order arguments are
/// computed is the compiler's choice.
class GeneratorRandom {
 public:
  explicit GeneratorRandom(uint64_t seed) : state_(seed) {}
  /// An independent sequence for item (tag, index): what it draws does not depend on what others draw.
  GeneratorRandom(uint64_t seed, uint64_t tag, uint64_t index = 0)
      : state_(mixBits(mixBits(mixBits(seed) ^ tag) + index)) {}

  uint64_t next() { return mixBits(state_ += kSplitmixStep); }
  /// Uniform in [0, 1), 24 bits.
  float unit() { return float(next() >> 40) * 0x1p-24f; }
  float uniform(float low, float high) { return low + (high - low) * unit(); }
  /// Uniform in 0 .. n - 1; n >= 1. (Biased by n / 2^32, which no scene shows.)
  uint32_t below(uint32_t n) { return uint32_t(((next() >> 32) * n) >> 32); }
  bool chance(float probability) { return unit() < probability; }

 private:
  uint64_t state_;
};

}  // namespace sightline
