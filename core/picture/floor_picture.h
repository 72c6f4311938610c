#pragma once
#include <span>

#include "core/cell/view_cell.h"
#include "core/picture/png.h"
#include "core/voxel/floor.h"

namespace sightline {

/// The floor from above, x to the right and z down, the highest where several lie over each other: tiles that
/// a cell covers green, others red, and the cells' outlines. is_covered: for each tile. Cells are boxes that
/// are not turned. At most `longest` pixels along a side. The floor is not empty.
Image floorPicture(const Lattice& lattice, const Floor& floor, std::span<const uint8_t> is_covered,
                   std::span<const ViewCell> cells, uint32_t longest);

}  // namespace sightline
