#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/measure/ranked_set.h"
#include "core/trace/tracer.h"

namespace sightline {

/// Most rays that countMissingRays takes.
inline constexpr uint32_t kMostMissingRays = 1u << 30;

/// Of the first `rays` validation rays that a bake with this seed and cell index traces: how many hit a
/// triangle outside the set, for each prefix of each set. rays: 1 .. kMostMissingRays. Each ray is traced
/// once, for all sets. Throws Error.
std::vector<std::vector<uint64_t>> countMissingRays(Tracer& tracer, const ViewCell& cell, uint32_t cell_index,
                                                    uint64_t seed, uint32_t rays,
                                                    std::span<const RankedSet> sets);

}  // namespace sightline
