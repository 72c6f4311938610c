#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/pvs/pvs_file.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace sightline {

/// Most rays that countObjectHits takes.
inline constexpr uint32_t kMostObjectRays = 1u << 30;

/// What random rays of a cell see: what ends them, and the glass before that.
struct ObjectHits {
  uint64_t hits = 0;                ///< rays that meet anything
  std::vector<uint64_t> of_object;  ///< by object of the scene: rays that see anything of it
};

/// Traces `rays` (1 .. kMostObjectRays) random rays of the cell, uniform over its surface and the directions
/// out of it. They are decided by seed, cell index and number alone, and are others than those that a bake
/// traces. Throws Error.
ObjectHits countObjectHits(Tracer& tracer, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                           uint64_t seed, uint32_t rays);

/// What each cell of a bake sees, as JSON: its place and the objects of which the set holds any triangle, in
/// the scene's order, each with its share of the hits (docs/report.md). hits: of the first cells of
/// pvs.cells, by `rays` each; cells without are left out. Objects with a share below `least` are left out,
/// too.
std::string objectsJson(const PvsFile& pvs, const Scene& scene, const std::vector<ObjectHits>& hits,
                        uint32_t rays, double least);

}  // namespace sightline
