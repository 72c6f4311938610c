#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/shared/types.h"

// Which points of the Halton sequence the random rays of a view cell take, face by face.
namespace sightline {

/// What random rays are for: each use has rays of its own.
enum class RandomUse : uint32_t { kSampling = 0, kValidation = 1, kCounting = 2, kChecking = 3 };

/// Random shifts (Cranley and Patterson 1976) of the four Halton bases, each below its period.
uvec4 haltonShifts(uint64_t seed, uint32_t cell_index, RandomUse use);

/// Shares of `total` in proportion to the faces' areas; they add up to total exactly (largest remainders,
/// ties to the lower face).
std::vector<uint32_t> raysByArea(std::span<const Face> faces, uint32_t total);

}  // namespace sightline
