#pragma once
#include <cstdint>
#include <vector>

#include "core/strip/lost_rays.h"

namespace sightline {

/// Aims rays of the cell at the triangles that `seen` (by id) does not mark, and marks what they see,
/// whatever they were aimed at. Random rays rarely meet what is small, and this is where they would be lost:
/// aimed ones meet a triangle as often as it is open to the cell, whatever its size.
///
/// rays_each: numbers of rays for each triangle, 1 .. 2^20. Most go the way that light leaves the triangle at
/// a random point of it, to either side, back from where that meets the cell's surface; where it does not,
/// there is no such ray. One in kAimedAtCell goes from a random point of the cell's surface: small cells are
/// met by few others. All are decided by seed, cell index, round and id: rounds have rays of their own.
/// Degenerate triangles get none. Returns how many triangles were not marked before. Where progress (told of
/// numbers of rays) ends it early, the rest gets none. Throws Error.
uint64_t markAimed(const TracedScene& scene, const ViewCell& cell, uint32_t cell_index, uint64_t seed,
                   uint32_t round, uint32_t rays_each, std::vector<bool>& seen,
                   const RayProgress& progress = {});

inline constexpr uint32_t kAimedAtCell = 8;

/// Marks the triangles that share an edge with one that is marked, by where its ends are. Returns how many
/// were not marked before: what lies beyond the border of what rays have seen, and may be seen by what no ray
/// passed.
uint64_t markNeighbours(const Scene& scene, std::vector<bool>& seen);

}  // namespace sightline
