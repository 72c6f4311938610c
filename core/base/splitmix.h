#pragma once
#include <cstdint>

namespace sightline {

// splitmix64 (G. Steele, D. Lea and C. Flood, Fast Splittable Pseudorandom Number Generators, 2014).

/// By how much the generator's state grows with each number drawn: 2^64 over the golden ratio, odd.
inline constexpr uint64_t kSplitmixStep = 0x9e3779b97f4a7c15u;

/// A bijection that mixes all bits. 0 stays 0.
constexpr uint64_t mixBits(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The first number of the generator with this seed.
constexpr uint64_t splitmix(uint64_t seed) {
  return mixBits(seed + kSplitmixStep);
}

}  // namespace sightline
