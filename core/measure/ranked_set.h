#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/pvs/pvs.h"
#include "core/shared/types.h"

namespace sightline {

/// A visible set with the order in which it was found, so that one look measures many states of a bake: what
/// was in the set when it had 1,000 triangles, when it had 10,000, and at the end.
struct RankedSet {
  std::vector<uint32_t> rank;      ///< a triangle of the scene: its place in the order; kNoRank: not in
  std::vector<uint32_t> prefixes;  ///< sizes to measure, ascending, 1 .. 65,535 of them: the triangles with
                                   ///< a rank below prefixes[k] are in set k
};

inline constexpr uint32_t kNoRank = 0xffffffffu;

/// A set without an order: prefixes {1}, rank 0 for its members. triangle_count: of the scene. Throws Error
/// for an id out of range, as does the next.
RankedSet rankedSet(std::span<const uint32_t> triangles, uint32_t triangle_count);

/// A device's list (CellSampler::readPvs), in the order of discovery. Triangles that the cell contains are
/// known before any ray: they get rank 0 and take no place, so a prefix counts triangles that rays found.
/// Prefix 0 holds nothing, not even those.
RankedSet rankedSet(std::span<const PvsEntry> entries, uint32_t triangle_count,
                    std::vector<uint32_t> prefixes);

/// By how many of the set's prefixes each triangle is missed: of the first so many.
std::vector<uint16_t> missingLevels(const RankedSet& set);

}  // namespace sightline
