#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace sightline {

/// A scene and what traces rays in it.
struct TracedScene {
  const Scene& scene;
  Tracer& tracer;
};

/// Told now and then of the rays so far; false ends the tracing early. May be empty.
using RayProgress = std::function<bool(uint64_t rays)>;

/// Marks in `seen` (by id) what `rays` random rays of the cell, 1 .. 2^30, see: what ends them, and all glass
/// before that. They are others than those of a bake with this seed and cell index. Returns how many
/// triangles were not marked before. Throws Error.
uint64_t markSeen(const TracedScene& scene, const ViewCell& cell, uint32_t cell_index, uint64_t seed,
                  uint32_t rays, std::vector<bool>& seen, const RayProgress& progress = {});

struct LostRays {
  uint64_t lost = 0;  ///< see, in the original scene, a triangle that the other one does not have
  uint64_t ties = 0;  ///< see only what it has, but there another one: as near, up to rounding, which the
                      ///< order of a triangle's corners decides
};

/// Traces `rays` (1 .. 2^30) random rays of the cell, others again, in both scenes. A triangle is the same if
/// its corners are, in whichever order. Where progress ends it early, `rays` becomes what was traced. Throws
/// Error.
LostRays countLostRays(const TracedScene& original, const TracedScene& stripped, const ViewCell& cell,
                       uint32_t cell_index, uint64_t seed, uint32_t& rays, const RayProgress& progress = {});

}  // namespace sightline
