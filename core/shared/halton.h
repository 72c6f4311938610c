// Halton points and random rays one at a time; and digits of few places, for the strata of random_ray.h.
#ifndef SL_HALTON_H
#define SL_HALTON_H
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kHaltonPeriod3 = 43046721u;   ///< 3^16
SL_CONST uint kHaltonPeriod5 = 244140625u;  ///< 5^12
SL_CONST uint kHaltonPeriod7 = 40353607u;   ///< 7^9

SL_NAMESPACE_END
#define SL_UINTS uint
#define SL_FLOATS float
#define SL_LANES(name) name
#define SL_MUL_HIGH(a, b) slMulHigh(a, b)
#define SL_TO_FLOATS(x) slFloat(x)
#include "core/shared/random_lanes.inl"
#undef SL_UINTS
#undef SL_FLOATS
#undef SL_LANES
#undef SL_MUL_HIGH
#undef SL_TO_FLOATS
SL_NAMESPACE_BEGIN

/// Point `index` of the base's sequence, shifted: floor(fraction * 2^24), in rare cases one less. Shifts are
/// below the period.
SL_FUNC uint halton2(uint64 index, uint shift) {
  return haltonPoint2(slUint(index), 0u, shift);
}
SL_FUNC uint halton3(uint64 index, uint shift) {
  return haltonPoint3(slUint(index % kHaltonPeriod3), 0u, shift);
}
SL_FUNC uint halton5(uint64 index, uint shift) {
  return haltonPoint5(slUint(index % kHaltonPeriod5), 0u, shift);
}
SL_FUNC uint halton7(uint64 index, uint shift) {
  return haltonPoint7(slUint(index % kHaltonPeriod7), 0u, shift);
}

/// The low `count` bits (0 .. 32) in reverse order.
SL_FUNC uint reverseBits(uint value, uint count) {
  return count == 0u ? 0u : reverseAllBits(value) >> (32u - count);
}

/// The low `count` digits in any base in reverse order: for few digits, or rarely.
SL_FUNC uint reverseDigits(uint value, uint base, uint count) {
  uint reversed = 0u;
  for (uint i = 0u; i < count; ++i) {
    reversed = reversed * base + value % base;
    value /= base;
  }
  return reversed;
}

SL_NAMESPACE_END
#endif
