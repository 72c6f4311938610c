#pragma once
// Numbers for random triangles of tests: the same from the same seed everywhere.
#include <cstdint>
#include <random>

namespace sightline {

inline float number(std::mt19937_64& random, double low, double high) {
  return float(low + (high - low) * double(random() >> 11) * 0x1p-53);
}

/// From low to high, both with their ends.
inline float whole(std::mt19937_64& random, int low, int high) {
  return float(low + int(random() % uint64_t(high - low + 1)));
}

}  // namespace sightline
