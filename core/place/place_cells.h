#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "core/cell/view_cell.h"
#include "core/path/camera_path.h"
#include "core/scene/in_solid.h"
#include "core/scene/scene.h"
#include "core/voxel/voxel_space.h"

namespace sightline {

/// More boxes than this are refused: bakes of a grid take minutes a cell, not milliseconds.
inline constexpr uint64_t kMaxGridBoxes = 10'000'000;

/// A part of space, from its low to its high corner.
struct GridRegion {
  glm::dvec3 low{0.0}, high{0.0};
};

struct GridOptions {
  glm::dvec3 size{4, 2, 4};  ///< of a box, and of the grid's steps; > 0, in the scene's units
  /// The low corner of the first box, grid-0-0-0: no box lies before it along any axis. Not set: the low
  /// corner of the region, or else of the scene's bounds.
  std::optional<glm::dvec3> origin;
  /// Only boxes with a part in it. Not set: the scene's bounds, of which `count` takes the upper end's place.
  std::optional<GridRegion> region;
  /// At most so many boxes along x, y and z, from the origin on; each at least 1.
  std::optional<std::array<uint64_t, 3>> count;
  /// Keep a box only if something lies at most so far below its underside; 0: however far.
  double max_height = 0;
  FreeSide free_side = FreeSide::kFront;  ///< kAny: keep boxes inside of solids, too
  /// Of this scene's voxels: keep boxes that a free voxel has a part in, whatever faces they see. With what
  /// reach (core/voxel/reach.h) made these are the boxes that are reached.
  const VoxelSpace* space = nullptr;
  /// How far boxes keep from triangles, at most an eighth of the smallest size; 0: they may touch some, and
  /// then see what is behind. Not set: defaultMargin (core/place/clear_box.h).
  std::optional<double> margin;
};

/// Why boxes of a grid were kept or not; the counts add up to `boxes`.
struct GridCounts {
  uint64_t boxes = 0;
  uint64_t kept = 0;
  uint64_t blocked = 0;        ///< a triangle is in them
  uint64_t nothing_below = 0;  ///< beside or under the world
  uint64_t too_high = 0;       ///< above max_height
  uint64_t in_solid = 0;       ///< more than half of what they see are wrong faces
  uint64_t not_reached = 0;    ///< no free voxel of the space has a part in them
  uint64_t inset = 0;          ///< of those kept: smaller than the grid's boxes, for the margin
};

/// What gridCells may be asked for besides cells; nothing of it changes them.
struct GridHooks {
  /// Told, on the caller's thread, how many of how many boxes have been looked at.
  std::function<void(uint64_t done, uint64_t boxes)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends it with Interrupted when it becomes true
};

/// View cells in free space: of the regular grid of boxes over the scene's bounds or what options say, those
///  - that no triangle reaches into by more than the margin (across an edge of the box: a little less),
///  - with something straight below their centre, within max_height,
///  - that are outside of solids: of rays from the centre in 64 directions that hit anything, at least half
///    hit a face of free_side; or, where options have a space, that are free there.
/// A side with triangles nearer than the margin comes in by what it takes to keep that distance, at most
/// twice the margin: a cell flush on a wall would see, from its surface, what is behind. All other sides stay
/// on the grid, so that cells go on meeting each other, and every place that is farther than twice the margin
/// from geometry is in one. Named grid-X-Y-Z by their place in the grid, from the origin; x runs fastest,
/// then z, then y. Result does not depend on the number of threads. bvh is of this scene. Throws Error (exit
/// code 2) for a size that is not positive and finite, a grid without boxes or with more than kMaxGridBoxes,
/// a margin too large for them; and Interrupted (core/gvs/bake_cell.h).
std::vector<ViewCell> gridCells(const Scene& scene, const Bvh& bvh, const GridOptions& options,
                                GridCounts* counts = nullptr, const GridHooks& hooks = {});

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

/// View cells along a camera's path.
struct WalkCells {
  std::vector<ViewCell> cells;
  std::vector<uint32_t> frames_left_out;  ///< the eye is nearer to a triangle than the margin
  uint64_t inset = 0;                     ///< cells that are smaller, for the margin
};

/// Few boxes that hold the eye of every frame of a walk but those left out: each along the line from its
/// first frame to its last, x level, no longer, wider and higher than options say, and its sides `margin`
/// away from triangles (0: wherever they are). Eyes keep a quarter of the width and height from the sides of
/// a box before these come in. Boxes in a row share a frame, so that they meet; none reaches over a cut.
/// Named walk-1, walk-2, ... The path has the scene's coordinates (Scene::offset). bvh is of this scene.
/// Throws Error (exit code 2) for sizes that are not positive and finite, and a margin too large for them.
WalkCells walkCells(const Scene& scene, const Bvh& bvh, const CameraPath& path, const PathOptions& options,
                    double margin);

/// Cells that keep clear of triangles, and those that cannot.
struct ClearCells {
  struct Blocked {
    ViewCell cell;
    uint64_t triangles = 0;  ///< that meet it
  };
  std::vector<ViewCell> cells;   ///< in the order given
  std::vector<Blocked> blocked;  ///< left out
  uint64_t inset = 0;            ///< of `cells`: smaller than given
};

/// Moves sides of the cells (boxes, turned or not) inwards until every triangle is `margin` away, each side
/// by at most a quarter of the cell's extent: half of it stays, and with it the middle line of a path. A cell
/// that triangles reach deeper into is left out: it would see, from their inside or behind a wall, what no
/// viewer on the path sees. margin is above 0. bvh is of this scene.
ClearCells keepClear(const Scene& scene, const Bvh& bvh, std::span<const ViewCell> cells, double margin);

}  // namespace sightline
