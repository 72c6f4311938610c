#pragma once
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace sightline {

/// memcpy by all threads: one alone copies slower than a GPU sends.
inline void parallelCopy(void* target, const void* source, uint64_t bytes) {
  constexpr uint64_t kPiece = 1u << 20;
  tbb::parallel_for(uint64_t(0), (bytes + kPiece - 1) / kPiece, [&](uint64_t i) {
    const uint64_t first = i * kPiece;
    std::memcpy(static_cast<char*>(target) + first, static_cast<const char*>(source) + first,
                std::min(kPiece, bytes - first));
  });
}

}  // namespace sightline
