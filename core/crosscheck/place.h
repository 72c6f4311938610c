#pragma once
#include <vector>

#include "core/cell/view_cell.h"
#include "core/scene/scene.h"

namespace sightline {

/// Scales scene and cells, then moves them along all three axes, in double, rounded to float: the same place
/// where floats are coarser or finer. Throws Error where a coordinate leaves the range of floats.
void placeElsewhere(Scene& scene, std::vector<ViewCell>& cells, double scale, double move);

}  // namespace sightline
