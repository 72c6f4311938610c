#pragma once
#include <cstdint>
#include <functional>

#include "core/cell/view_cell.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace sightline {

/// A scene and what traces rays in it.
struct TracedScene {
  const Scene& scene;
  Tracer& tracer;
};

/// Of `rays` random rays of the cell, of other numbers than a bake with this seed and cell index takes: how
/// many meet first, in the original scene, a triangle that is not what they meet first in the other one: none
/// there, or one with other corners. Calls progress(rays so far) now and then; false ends it early, and
/// `rays` becomes what was traced. rays: 1 .. 2^30. Throws Error.
uint64_t countLostRays(const TracedScene& original, const TracedScene& stripped, const ViewCell& cell,
                       uint32_t cell_index, uint64_t seed, uint32_t& rays,
                       const std::function<bool(uint64_t)>& progress = {});

}  // namespace sightline
