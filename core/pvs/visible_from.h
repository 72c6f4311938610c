#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "core/pvs/pvs_file.h"

namespace sightline {

/// The baked cell that answers for a viewer at a position (in the coordinates of the scene's file): the first
/// of pvs.cells that contains it (cellContains: surfaces belong to their cell). The set of each such cell
/// holds what is seen from there; so bake small cells before the large ones that hold them, where the closer
/// answer is wanted. A flat cell looks along its +z only, and its set is what a viewer on it sees in front.
/// Null: no baked cell contains the position, or it is not finite.
///
/// Time grows with the number of cells, by some nanoseconds a cell; memory is not allocated but for cells
/// near the position. Any number of threads may ask at once.
const CellPvs* cellAt(const PvsFile& pvs, const glm::dvec3& position);

/// Ids of the triangles that may be seen from the position, ascending: those of cellAt. What is not among
/// them is hidden, up to what the bake missed (CellStats: validation_rays, missing_rays). They point into
/// `pvs`. Nothing: no baked cell contains the position, so nothing is known: draw everything. An empty span:
/// what the cell sees was baked, and is nothing.
std::optional<std::span<const uint32_t>> visibleFrom(const PvsFile& pvs, const glm::dvec3& position);

/// Whether the doors of a bake (PvsFile::doors) are in their places or away.
enum class DoorState { kClosed, kOpen };

/// What may be seen, in two runs of ids without one in common, each ascending.
struct VisibleIds {
  std::span<const uint32_t> triangles;  ///< with the doors closed
  std::span<const uint32_t> added;      ///< with the doors open besides; empty where they are closed
};

/// The same for a state of the doors. A bake without doors, and with them kClosed, adds nothing. Open: the
/// doors' own triangles are among those that may be seen, so the ids hold for doors of which some are open,
/// and for half-open ones (docs/doors-and-gaps.md).
std::optional<VisibleIds> visibleFrom(const PvsFile& pvs, const glm::dvec3& position, DoorState state);

}  // namespace sightline
