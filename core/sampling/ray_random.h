#pragma once
#include <cstdint>

#include "core/base/splitmix.h"
#include "core/shared/language.h"

namespace sightline {

/// Random numbers of one ray: a stream of its own for each key and number, in any order.
class RayRandom {
 public:
  RayRandom(uint64_t key, uint64_t number) : state_(splitmix(key ^ splitmix(number))) {}

  uint64_t bits() { return splitmix(state_ += kSplitmixStep); }
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
