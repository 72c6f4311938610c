#pragma once
#include <span>

#include "core/pvs/cell_pvs.h"
#include "core/shared/types.h"

namespace sightline {

/// Fills an empty set of a cell from the list of its device, in any order: triangles in ascending id, each
/// with its witness.
void fillSet(std::span<const PvsEntry> entries, CellPvs& pvs);

}  // namespace sightline
