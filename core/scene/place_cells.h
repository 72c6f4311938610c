#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "core/scene/scene.h"
#include "core/scene/view_cell.h"

namespace sightline {

/// More boxes than this are refused: bakes of a grid take minutes a cell, not milliseconds.
inline constexpr uint64_t kMaxGridBoxes = 10'000'000;

/// Which faces free space is on. Front faces are counter-clockwise seen from there; exported levels often
/// have it the other way round.
enum class FreeSide { kFront, kBack, kAny };

struct GridOptions {
  glm::dvec3 size{4, 2, 4};  ///< of a box, and of the grid's steps; > 0, in the scene's units
  /// A corner where eight boxes of the grid meet. Not set: the low corner of the scene's bounds.
  std::optional<glm::dvec3> origin;
  /// Keep a box only if something lies at most so far below its underside; 0: however far.
  double max_height = 0;
  FreeSide free_side = FreeSide::kFront;  ///< kAny: keep boxes inside of solids, too
};

/// Why boxes of a grid were kept or not; the counts add up to `boxes`.
struct GridCounts {
  uint64_t boxes = 0;
  uint64_t kept = 0;
  uint64_t blocked = 0;        ///< a triangle is in them
  uint64_t nothing_below = 0;  ///< beside or under the world
  uint64_t too_high = 0;       ///< above max_height
  uint64_t in_solid = 0;       ///< more than half of what they see are wrong faces
};

/// View cells in free space: of the regular grid of boxes over the scene's bounds, those
///  - that no triangle meets (one may touch a side: a cell may stand on the floor),
///  - with something straight below their centre, within max_height,
///  - that are outside of solids: of rays from the centre in 64 directions that hit anything, at least half
///  hit
///    a face of free_side.
/// Named grid-X-Y-Z by their place in the grid; x runs fastest, then z, then y. Result does not depend on the
/// number of threads. bvh is of this scene. Throws Error (exit code 2) for a size that is not positive and
/// finite, or more than kMaxGridBoxes boxes.
std::vector<ViewCell> gridCells(const Scene& scene, const Bvh& bvh, const GridOptions& options,
                                GridCounts* counts = nullptr);

struct PathOptions {
  double width = 2.5, height = 2;  ///< across the path, sideways and up; > 0
  double length = 150;             ///< of a box along the path at most; > 0
};

/// Boxes whose middle lines tile the polyline through points, local z along the path, x level. A stretch
/// between two points is cut into the fewest equal boxes that are at most `length` long. Where the path turns
/// by up to 90 degrees, the boxes at the bend are longer by as much as it takes to leave no gap on the outer
/// side (by half their width at a right angle; and for sharper turns, where a gap stays).
/// Named path-1, path-2, ... Points twice in a row are one. Throws Error (exit code 2) for fewer than two
/// different points and sizes or points that are not finite.
std::vector<ViewCell> pathCells(std::span<const glm::dvec3> points, const PathOptions& options);

}  // namespace sightline
