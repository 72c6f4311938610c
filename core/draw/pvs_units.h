#pragma once
#include <optional>

#include "core/draw/triangle_lists.h"
#include "core/pvs/pvs_file.h"

namespace sightline {

/// What is drawn in each cell of a set.
struct PvsUnits {
  std::vector<ViewCell> cells;                   ///< as in the scene: less Scene::offset
  TriangleLists triangles;                       ///< of each cell
  std::vector<std::vector<uint32_t>> drawables;  ///< of each cell those with a triangle in its set, ascending

  /// The cell for a viewer at the place. hint: the last one, which stays as long as it holds the place, so
  /// that cells that overlap do not take turns; else of those that hold it that with the fewest triangles,
  /// each being valid alone, of equal ones the first. Nothing: none does, or the place is not finite. A
  /// rectangle's set holds for viewers on it that look along its normal only.
  std::optional<uint32_t> cellAt(const glm::dvec3& place, std::optional<uint32_t> hint = {}) const;

  /// The cell whose box is nearest to a finite place, of equally near ones the first; nothing where there are
  /// no cells.
  std::optional<uint32_t> nearestCell(const glm::dvec3& place) const;
};

/// The set must be of the scene (core/bake/require_scene.h). Doors are taken as open where open_doors says
/// so.
PvsUnits makePvsUnits(const PvsFile& pvs, const Drawables& drawables, bool open_doors = false);

/// The other way about: of each triangle of the scene, by id, the drawable that it is in.
std::vector<uint32_t> drawableOfTriangles(const Drawables& drawables);

}  // namespace sightline
