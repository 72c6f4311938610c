// Halton points in the bases 2, 3, 5 and 7 as 24-bit fixed-point fractions, by integers only.
//
// Based on: Halton, On the efficiency of certain quasi-random sequences of points in evaluating
// multi-dimensional integrals, Numerische Mathematik 2, 1960; randomised by a shift modulo 1 (Cranley and
// Patterson 1976). The index has 64 bits and never restarts. Each base keeps as many digits as fit 32 bits
// (2^32, 3^20, 5^13, 7^11): more than a float resolves; as the four periods are coprime, no point of the
// four-dimensional sequence repeats.
#ifndef SL_HALTON_H
#define SL_HALTON_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kHaltonPeriod3 = 3486784401u;  ///< 3^20
SL_CONST uint kHaltonPeriod5 = 1220703125u;  ///< 5^13
SL_CONST uint kHaltonPeriod7 = 1977326743u;  ///< 7^11

/// The low `count` digits of value in `base`, in reverse order. magic and shift divide by the base: value /
/// base == mulHigh(value, magic) >> shift for every 32-bit value (for 7: see reverseDigits7).
SL_FUNC uint reverseDigits(uint value, uint base, uint magic, uint shift, uint count) {
  uint reversed = 0u;
  for (uint i = 0u; i < count; ++i) {
    uint quotient = slMulHigh(value, magic) >> shift;
    reversed = reversed * base + (value - quotient * base);
    value = quotient;
  }
  return reversed;
}

/// The same for base 2.
SL_FUNC uint reverseDigits2(uint value, uint count) {
  value = ((value >> 1) & 0x55555555u) | ((value & 0x55555555u) << 1);
  value = ((value >> 2) & 0x33333333u) | ((value & 0x33333333u) << 2);
  value = ((value >> 4) & 0x0f0f0f0fu) | ((value & 0x0f0f0f0fu) << 4);
  value = ((value >> 8) & 0x00ff00ffu) | ((value & 0x00ff00ffu) << 8);
  value = (value >> 16) | (value << 16);
  return count == 0u ? 0u : value >> (32u - count);
}

SL_FUNC uint reverseDigits3(uint value, uint count) {
  return reverseDigits(value, 3u, 0xaaaaaaabu, 1u, count);
}
SL_FUNC uint reverseDigits5(uint value, uint count) {
  return reverseDigits(value, 5u, 0xcccccccdu, 2u, count);
}

/// Division by 7 needs a 33-bit magic number in general; below 2^31 this 32-bit one is exact.
SL_FUNC uint reverseDigits7(uint value, uint count) {
  return reverseDigits(value, 7u, 0x92492493u, 2u, count);
}

/// a + b modulo period, for a and b below it.
SL_FUNC uint addModulo(uint a, uint b, uint period) {
  return a >= period - b ? a - (period - b) : a + b;
}

/// Point `index` of the base's sequence, shifted: floor(fraction * 2^24). Shifts are below the period.
SL_FUNC uint halton2(uint64 index, uint shift) {
  return (reverseDigits2(slUint(index), 32u) + shift) >> 8;
}

SL_FUNC uint halton3(uint64 index, uint shift) {
  uint digits = reverseDigits3(slUint(index % kHaltonPeriod3), 20u);
  return slMulHigh(addModulo(digits, shift, kHaltonPeriod3), 20665916u);  // 2^56 / 3^20
}

SL_FUNC uint halton5(uint64 index, uint shift) {
  uint digits = reverseDigits5(slUint(index % kHaltonPeriod5), 13u);
  return slMulHigh(addModulo(digits, shift, kHaltonPeriod5), 59029581u);  // 2^56 / 5^13
}

SL_FUNC uint halton7(uint64 index, uint shift) {
  uint digits = reverseDigits7(slUint(index % kHaltonPeriod7), 11u);
  return slMulHigh(addModulo(digits, shift, kHaltonPeriod7), 36441925u);  // 2^56 / 7^11
}

/// The fraction as a float in [0, 1), exactly.
SL_FUNC float haltonFraction(uint fixed24) {
  return slFloat(fixed24) * 5.9604644775390625e-8f;
}

SL_NAMESPACE_END
#endif
