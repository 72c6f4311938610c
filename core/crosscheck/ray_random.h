#pragma once
#include <cstdint>

#include "core/shared/language.h"

namespace sightline {

/// splitmix64 (Steele, Lea and Flood 2014): a bijection that mixes all bits.
inline uint64_t mixBits(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Random numbers of one ray: a stream of its own for each key and number, in any order.
class RayRandom {
 public:
  RayRandom(uint64_t key, uint64_t number) : state_(mixBits(key ^ mixBits(number))) {}

  uint64_t bits() { return mixBits(state_ += 0x9e3779b97f4a7c15u); }
  /// 0 .. n - 1
  uint32_t pick(uint64_t n) { return uint32_t((bits() >> 32) * n >> 32); }
  /// [0, 1)
  float unit() { return float(bits() >> 40) * 0x1p-24f; }
  /// Components in [-1, 1).
  vec3 point() {
    const float x = unit(), y = unit(), z = unit();
    return vec3(x, y, z) * 2.0f - 1.0f;
  }

 private:
  uint64_t state_;
};

}  // namespace sightline
