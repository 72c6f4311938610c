#include "core/pvs/visible_from.h"

#include <algorithm>

#include "core/cell/cell_contains.h"

namespace sightline {

const CellPvs* cellAt(const PvsFile& pvs, const glm::dvec3& position) {
  const auto found = std::ranges::find_if(pvs.cells, [&, place = position - pvs.offset](const CellPvs& cell) {
    return cellContains(cell.cell, place);
  });
  return found == pvs.cells.end() ? nullptr : &*found;
}

std::optional<std::span<const uint32_t>> visibleFrom(const PvsFile& pvs, const glm::dvec3& position) {
  const CellPvs* cell = cellAt(pvs, position);
  if (cell == nullptr) return {};
  return cell->triangles;
}

std::optional<VisibleIds> visibleFrom(const PvsFile& pvs, const glm::dvec3& position, DoorState state) {
  const CellPvs* cell = cellAt(pvs, position);
  if (cell == nullptr) return {};
  VisibleIds ids{cell->triangles, {}};
  if (state == DoorState::kOpen && cell->open) ids.added = cell->open->triangles;
  return ids;
}

}  // namespace sightline
