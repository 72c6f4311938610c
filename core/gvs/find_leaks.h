#pragma once
#include "core/cell/view_cell.h"
#include "core/gvs/leaks.h"
#include "core/pvs/cell_pvs.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace sightline {

/// A thousandth of the cell's largest extent.
float leakWidth(const ViewCell& cell);

/// Looks for them. A triangle counts if its witness is pinched (core/trace/narrow_gap.h) and so are, or do
/// not meet it, 16 more rays to it: half from anywhere on the cell, half from near where its witness begins.
/// So the number is no proof: a few triangles that are seen past a gap, but from few places, may be among
/// them. Triangles that the cell contains do not count. pvs: with witnesses. Traces mostly 10 rays for each
/// triangle of the set, and some 300 for each that its witness sees through a gap. Deterministic, whatever
/// the threads. tracer: of the scene. Throws Error.
Leaks findLeaks(Tracer& tracer, const Scene& scene, const CellPvs& pvs, float width);

}  // namespace sightline
