#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/cell/view_cell.h"
#include "core/scene/in_solid.h"
#include "core/scene/scene.h"
#include "core/shared/types.h"

namespace sightline {

/// What can be wrong with a view cell, although it can be baked. Each may be meant: a flight above a terrain
/// is far outside the scene, a room of twelve triangles is seen whole from within.
enum class CellVerdict {
  kMeetsTriangles,  ///< triangles cut or touch it (containedTriangles; of a flat cell: from the front), so
                    ///< its surface has parts inside or behind them: it sees what no viewer beside them sees
  kInSolid,   ///< most of what is seen from its centre are back faces (inSolid), for a flat cell of what is
              ///< in front: it is inside something, or the scene's faces are turned (free_side)
  kOutside,   ///< apart from the scene's bounds by more than its own extent and a quarter of their diagonal
  kTooLarge,  ///< its largest extent is above the scene's diagonal: another unit?
  kTooSmall,  ///< its largest extent is below a millionth of the scene's diagonal, or one (that is not 0)
              ///< below four times the spacing of floats where it is: another unit, or too far out
  kSeesNothing,     ///< after the bake: the set is empty
  kSeesEverything,  ///< after the bake: the set holds every triangle that has an area
};

struct CellWarning {
  CellVerdict verdict;
  std::string text;        ///< goes on after the cell's name: "meets 12 triangles, so it sees ..."
  uint64_t triangles = 0;  ///< of kMeetsTriangles: how many
};

/// "meets triangles", "in solid", "outside", "too large", "too small", "sees nothing", "sees everything".
const char* verdictName(CellVerdict verdict);

/// Nearest hits of rays: hits.size() == rays.size().
using NearestHits = std::function<void(std::span<const Ray> rays, std::span<Hit> hits)>;

/// What can be said before the bake, for each cell, in the order of CellVerdict; mostly nothing. bvh is of
/// this scene; 64 rays a cell are traced by `trace`, a call a cell.
std::vector<std::vector<CellWarning>> checkCells(const Scene& scene, const Bvh& bvh,
                                                 std::span<const ViewCell> cells, FreeSide free_side,
                                                 const NearestHits& trace);

/// What can be said of a cell by the size of its set. triangles: of the scene, those without area left out.
std::optional<CellWarning> checkSetSize(uint64_t set_size, uint64_t triangles);

}  // namespace sightline
