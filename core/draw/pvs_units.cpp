#include "core/draw/pvs_units.h"

#include <algorithm>
#include <array>

#include "core/cell/cell_contains.h"
#include "core/cell/cell_frame.h"

namespace sightline {

namespace {

/// Square of the distance from a place to the cell's box.
double squaredDistanceTo(const ViewCell& cell, const glm::dvec3& place) {
  const CellFrame frame = cellFrame(cell);
  const glm::dvec3 away = glm::max(glm::abs(frame.toLocal(place)) - frame.half_size, glm::dvec3(0.0));
  return (away.x * away.x + away.y * away.y) + away.z * away.z;
}

TriangleList listOf(const std::vector<uint32_t>& ids, const Drawables& drawables,
                    const std::vector<uint32_t>& owner) {
  std::array<std::vector<uint32_t>, 3> kinds;
  for (const uint32_t id : ids) kinds[size_t(drawables.list[owner[id]].alpha)].push_back(id);
  TriangleList list;
  list.ids = std::move(kinds[0]);
  list.masked_begin = static_cast<uint32_t>(list.ids.size());
  list.ids.insert(list.ids.end(), kinds[1].begin(), kinds[1].end());
  list.blended_begin = static_cast<uint32_t>(list.ids.size());
  list.ids.insert(list.ids.end(), kinds[2].begin(), kinds[2].end());
  return list;
}

}  // namespace

std::optional<uint32_t> PvsUnits::cellAt(const glm::dvec3& place, std::optional<uint32_t> hint) const {
  if (hint && *hint < cells.size() && cellContains(cells[*hint], place)) return hint;
  std::optional<uint32_t> best;
  for (uint32_t c = 0; c < cells.size(); ++c) {
    if (best && triangles.lists[c].ids.size() >= triangles.lists[*best].ids.size()) continue;
    if (cellContains(cells[c], place)) best = c;
  }
  return best;
}

std::optional<uint32_t> PvsUnits::nearestCell(const glm::dvec3& place) const {
  std::optional<uint32_t> best;
  double least = 0;
  for (uint32_t c = 0; c < cells.size(); ++c) {
    const double distance = squaredDistanceTo(cells[c], place);
    if (best && !(distance < least)) continue;
    best = c;
    least = distance;
  }
  return best;
}

PvsUnits makePvsUnits(const PvsFile& pvs, const Drawables& drawables, bool open_doors) {
  PvsUnits units;
  const std::vector<uint32_t> owner = drawableOfTriangles(drawables);
  std::vector<uint32_t> seen_in(drawables.list.size(), ~0u);
  for (const CellPvs& cell : pvs.cells) {
    std::vector<uint32_t> ids = cell.triangles;
    if (open_doors && cell.open) {
      const size_t middle = ids.size();
      ids.insert(ids.end(), cell.open->triangles.begin(), cell.open->triangles.end());
      std::inplace_merge(ids.begin(), ids.begin() + middle, ids.end());
    }
    std::vector<uint32_t> seen;
    const uint32_t mark = static_cast<uint32_t>(units.cells.size());
    for (const uint32_t id : ids) {
      if (seen_in[owner[id]] == mark) continue;
      seen_in[owner[id]] = mark;
      seen.push_back(owner[id]);
    }
    std::sort(seen.begin(), seen.end());
    units.cells.push_back(cell.cell);
    units.triangles.lists.push_back(listOf(ids, drawables, owner));
    units.drawables.push_back(std::move(seen));
  }
  return units;
}

std::vector<uint32_t> drawableOfTriangles(const Drawables& drawables) {
  std::vector<uint32_t> owner(drawables.triangles.size());
  for (uint32_t d = 0; d < drawables.list.size(); ++d) {
    for (const uint32_t id : drawables.trianglesOf(d)) owner[id] = d;
  }
  return owner;
}

}  // namespace sightline
