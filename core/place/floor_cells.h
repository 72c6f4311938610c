#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "core/cell/view_cell.h"
#include "core/scene/in_solid.h"
#include "core/scene/scene.h"
#include "core/voxel/floor.h"

namespace sightline {

struct FloorCellOptions {
  double largest = 4;  ///< sides of a cell, seen from above, at most
  double least = 0.5;  ///< and at least: what is narrower is not covered
  double eye = 1.6;    ///< of the eye above the floor; above 0
  double head = 1.8;   ///< of the cells, and of the space that must be free above the floor; at least eye
  double step = 0.4;   ///< by which the floor under a cell may rise; less than eye, at most half of head
  /// How far cells keep from triangles, at most an eighth of `least`; 0: as far as their voxels do. Not set:
  /// defaultMargin (core/place/clear_box.h).
  std::optional<double> margin;
  /// Leave out cells inside of solids by the rays of inSolid (core/scene/in_solid.h), and the tiles under
  /// them; of parts of the floor that are more inside than outside, all.
  FreeSide free_side = FreeSide::kAny;
  std::function<void(double done)> progress = {};  ///< on the caller's thread, 0 to 1, ascending
  const std::atomic<bool>* stop = nullptr;         ///< ends it with Interrupted when it becomes true
};

struct FloorCells {
  std::vector<ViewCell> cells;
  Floor floor;                      ///< without what is in solids by free_side
  std::vector<uint8_t> is_covered;  ///< coveredTiles
  uint64_t covered = 0;             ///< tiles of it: the eye of who stands on its middle is in a cell
  uint64_t inset = 0;               ///< cells that are smaller, for the margin
  uint64_t in_solid = 0;            ///< cells that were left out for free_side
};

/// Where one walks, of all parts of the floor.
struct WalkedFloor {
  Floor floor;
  uint64_t all_parts = 0;
};

/// The parts of the space's floor on which one comes to stand from free places of the scene's space; without
/// places those that are at least as large as a cell may be, so not tables and ledges. Throws Error (exit
/// code 2) for a place without a floor below it, and where no part is large enough; as floorOptions and
/// findFloor.
WalkedFloor walkedFloor(const VoxelSpace& space, std::span<const glm::dvec3> places,
                        const FloorCellOptions& options);

/// What the lengths are in voxels. Throws Error (exit code 2) for lengths out of their ranges.
FloorOptions floorOptions(const Lattice& lattice, const FloorCellOptions& options);

/// View cells where one walks: boxes that stand on the floor, up to head, each over tiles that are neighbours
/// and without a gap, and so level that it holds the eye of who stands anywhere under it: it stands on the
/// highest of them, at most half the eye's height above the lowest. The first is the one that covers most of
/// the floor, the next the one that covers most of what is left, and so on, cut around what stands on the
/// floor down to `least`, as long as one covers more than a square of that size. They meet or overlap, so
/// that they are few. Made of voxels that no triangle meets, with their sides in by the margin where
/// triangles are near, they hold no triangle, no part of anything solid, and are over no hole.
///
/// Named floor-1, floor-2, ... by height, then z, then x. floor: of this scene's voxels on this lattice,
/// found with floorOptions. bvh is of this scene. The same on any number of threads. Throws Error (exit code
/// 2) for lengths out of their ranges, or of less than a voxel; and Interrupted.
FloorCells floorCells(const Scene& scene, const Bvh& bvh, const Lattice& lattice, const Floor& floor,
                      const FloorCellOptions& options);

/// For each tile of the floor 1 if the eye of who stands on its middle is in a cell, else 0. Cells are boxes
/// that are not turned.
std::vector<uint8_t> coveredTiles(const Lattice& lattice, const Floor& floor, double eye,
                                  std::span<const ViewCell> cells);

}  // namespace sightline
