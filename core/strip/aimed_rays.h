#pragma once
#include <cstdint>
#include <vector>

#include "core/strip/lost_rays.h"

namespace sightline {

/// Which rays are aimed. All are decided by these, the triangle's id and their number: rounds have rays of
/// their own.
struct AimedRays {
  uint32_t cell_index = 0;
  uint64_t seed = 0;
  uint32_t round = 0;
  uint32_t each = 1;  ///< numbers of rays for each triangle, 1 .. 2^20
};

/// Aims rays of the cell at the triangles that `kept` (by id) does not mark, and marks in `seen` what they
/// see, whatever they were aimed at. Random rays rarely meet what is small, and this is where they would be
/// lost: aimed ones meet a triangle as often as it is open to the cell, whatever its size.
///
/// Most go the way that light leaves the triangle at a random point of it, to either side, back from where
/// that meets the cell's surface; where it does not, there is no such ray. One in kAimedAtCell goes from a
/// random point of the cell's surface: small cells are met by few others. Degenerate triangles get none.
/// Returns how many triangles came to be seen that are not kept. Where progress (told of numbers of rays)
/// ends it early, the rest gets none. Throws Error.
uint64_t markAimed(const TracedScene& scene, const ViewCell& cell, const AimedRays& aimed,
                   const std::vector<bool>& kept, std::vector<bool>& seen, const RayProgress& progress = {});

inline constexpr uint32_t kAimedAtCell = 8;

/// The triangles that `seen` marks and those that share an edge with one of them, by where its ends are: what
/// lies beyond the border of what rays have seen may be seen where no ray passed.
std::vector<bool> withNeighbours(const Scene& scene, const std::vector<bool>& seen);

}  // namespace sightline
