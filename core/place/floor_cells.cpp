#include "core/place/floor_cells.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/place/clear_box.h"
#include "core/place/floor_patches.h"
#include "core/place/probe_solid.h"

namespace sightline {
namespace {

constexpr double kMostInset = 2;  // margins by which a side comes in at most, as in a grid

FloorLimits limitsOf(const Lattice& lattice, const FloorCellOptions& options) {
  const double size = lattice.voxelSize();
  const auto down = [&](double length) { return int(std::min(std::floor(length / size), 0x1p20)); };
  const auto up = [&](double length) { return int(std::min(std::ceil(length / size), 0x1p20)); };
  return {down(options.largest), up(options.least), down(options.eye), up(options.head), down(options.step)};
}

void checkLengths(const Lattice& lattice, const FloorCellOptions& options) {
  const auto refuse = [](const std::string& what) { throw Error("cells on the floor: " + what, kExitUsage); };
  for (const double length : {options.largest, options.least, options.eye, options.head, options.step}) {
    if (!std::isfinite(length) || length < 0) refuse("lengths must be finite numbers, and not negative");
  }
  const double size = lattice.voxelSize();
  if (options.least < size || options.eye < size) {
    refuse(fmt::format("the least size ({:g}) and the eye's height ({:g}) must be a voxel ({:g}) or more",
                       options.least, options.eye, size));
  }
  const FloorLimits limits = limitsOf(lattice, options);
  if (limits.largest < limits.least) {
    refuse(fmt::format("the largest size ({:g}) must hold the least ({:g}) in whole voxels of {:g}",
                       options.largest, options.least, size));
  }
  if (options.head < options.eye) {
    refuse(
        fmt::format("the head's height ({:g}) must be the eye's ({:g}) or more", options.head, options.eye));
  }
  if (options.step > options.head / 2 || options.step >= options.eye) {
    refuse(
        fmt::format("a step ({:g}) must be at most half of the head's height ({:g}), and less than the "
                    "eye's ({:g})",
                    options.step, options.head, options.eye));
  }
}

// The voxels of a patch's box.
VoxelBox boxOf(const FloorPatch& patch, const Floor& floor, int head) {
  const FloorTile& corner = floor.tiles[patch.tile];
  const int top = std::min(patch.heights.ceiling, patch.heights.high + head);
  return {{corner.x, patch.heights.high, corner.z},
          {corner.x + patch.x - 1, top - 1, corner.z + patch.z - 1}};
}

ViewCell cellOf(const Lattice& lattice, const VoxelBox& box) {
  const double size = lattice.voxelSize();
  const glm::dvec3 low = glm::dvec3(box.low) * size, high = glm::dvec3(box.high + 1) * size;
  return {"", (low + high) * 0.5, high - low, glm::dvec3(0)};
}

// With its sides in by the margin; where that is not enough, with a layer of voxels less.
std::optional<ViewCell> clearCell(const Scene& scene, const Bvh& bvh, const Lattice& lattice, VoxelBox box,
                                  double margin) {
  for (int tries = 0; tries < 2; ++tries) {
    const ViewCell cell = cellOf(lattice, box);
    if (margin == 0) return cell;
    const std::optional<SideInsets> insets =
        insetsToClear(scene, bvh, cellFrame(cell), margin, glm::dvec3(kMostInset * margin));
    if (insets) return withInsets(cell, *insets);
    box = {box.low + 1, box.high - 1};
    if (box.low.x > box.high.x || box.low.y > box.high.y || box.low.z > box.high.z) break;
  }
  return std::nullopt;
}

// A patch's box, and what becomes of it.
struct Placed {
  VoxelBox box;
  uint32_t part = 0;
  std::optional<ViewCell> cell;
  bool is_solid = false;

  uint64_t tiles() const {
    return uint64_t(box.high.x - box.low.x + 1) * uint64_t(box.high.z - box.low.z + 1);
  }
};

// The parts of which not more is found in solids than out of them.
std::vector<bool> freeParts(const Floor& floor, const std::vector<Placed>& placed) {
  std::vector<int64_t> balance(floor.part_sizes.size(), 0);
  for (const Placed& one : placed) {
    if (one.cell) balance[one.part] += one.is_solid ? -int64_t(one.tiles()) : int64_t(one.tiles());
  }
  std::vector<bool> is_free(balance.size());
  for (size_t i = 0; i < balance.size(); ++i) is_free[i] = balance[i] >= 0;
  return is_free;
}

// The tiles of the parts that are free, but those that only cells in solids cover.
Floor withoutSolid(const Lattice& lattice, const Floor& floor, const std::vector<bool>& is_free, double eye,
                   std::span<const ViewCell> in_solid, std::span<const ViewCell> cells) {
  const std::vector<uint8_t> solid = coveredTiles(lattice, floor, eye, in_solid);
  const std::vector<uint8_t> free = coveredTiles(lattice, floor, eye, cells);
  return tilesOf(floor, [&](uint32_t tile) {
    return is_free[floor.tiles[tile].part] && (solid[tile] == 0 || free[tile] != 0);
  });
}

}  // namespace

FloorOptions floorOptions(const Lattice& lattice, const FloorCellOptions& options) {
  checkLengths(lattice, options);
  const FloorLimits limits = limitsOf(lattice, options);
  return {.head = limits.head, .step = limits.step};
}

WalkedFloor walkedFloor(const VoxelSpace& space, std::span<const glm::dvec3> places,
                        const FloorCellOptions& options) {
  const Lattice& lattice = space.grid().lattice;
  FloorOptions floor_options = floorOptions(lattice, options);
  floor_options.stop = options.stop;
  const Floor all = findFloor(space, floor_options);
  std::vector<bool> keep(all.part_sizes.size(), false);
  for (const glm::dvec3& place : places) {
    const uint32_t tile = tileBelow(all, space, voxelAt(lattice, place));
    if (tile == FloorTile::kNoTile) {
      throw Error(
          fmt::format("cells on the floor: there is none to stand on below {:g},{:g},{:g}: take a place "
                      "over a floor with {:g} free above it, or smaller voxels",
                      place.x, place.y, place.z, options.head),
          kExitUsage);
    }
    keep[all.tiles[tile].part] = true;
  }
  const double along = options.largest / lattice.voxelSize();
  for (size_t i = 0; places.empty() && i < keep.size(); ++i) {
    keep[i] = double(all.part_sizes[i]) >= along * along;
  }
  WalkedFloor walked{tilesOf(all, [&](uint32_t tile) { return keep[all.tiles[tile].part]; }),
                     all.part_sizes.size()};
  if (!walked.floor.tiles.empty()) return walked;
  throw Error(
      fmt::format("cells on the floor: no part of it with {:g} free above is as large as a cell may be, "
                  "{:g}: take smaller ones, or the part below a place",
                  options.head, options.largest),
      kExitUsage);
}

FloorCells floorCells(const Scene& scene, const Bvh& bvh, const Lattice& lattice, const Floor& floor,
                      const FloorCellOptions& options) {
  checkLengths(lattice, options);
  const double smallest = std::min(options.least, options.eye);
  const double margin = options.margin.value_or(defaultMargin(sceneBounds(scene), smallest));
  checkMargin(margin, smallest, "cells on the floor");
  const FloorLimits limits = limitsOf(lattice, options);
  std::vector<Placed> placed;
  for (const FloorPatch& patch : coverFloor(floor, limits, {options.progress, options.stop})) {
    placed.push_back({boxOf(patch, floor, limits.head), floor.tiles[patch.tile].part, {}, false});
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return std::tie(a.box.low.y, a.box.low.z, a.box.low.x) < std::tie(b.box.low.y, b.box.low.z, b.box.low.x);
  });
  const CpuTracer tracer(scene, bvh);
  const SolidProbe probe(scene, tracer, options.free_side);
  tbb::parallel_for(size_t{0}, placed.size(), [&](size_t i) {
    if (options.stop != nullptr && *options.stop) return;
    placed[i].cell = clearCell(scene, bvh, lattice, placed[i].box, margin);
    placed[i].is_solid = placed[i].cell && probe.isInSolid(placed[i].cell->center);
  });
  if (options.stop != nullptr && *options.stop) throw Interrupted();
  const std::vector<bool> is_free = freeParts(floor, placed);
  FloorCells result;
  std::vector<ViewCell> in_solid;
  for (Placed& one : placed) {
    if (!one.cell) continue;
    if (!is_free[one.part] || one.is_solid) {
      in_solid.push_back(std::move(*one.cell));
      continue;
    }
    one.cell->name = fmt::format("floor-{}", result.cells.size() + 1);
    result.inset += one.cell->size != cellOf(lattice, one.box).size;
    result.cells.push_back(std::move(*one.cell));
  }
  result.in_solid = in_solid.size();
  result.floor = withoutSolid(lattice, floor, is_free, options.eye, in_solid, result.cells);
  result.is_covered = coveredTiles(lattice, result.floor, options.eye, result.cells);
  result.covered = uint64_t(std::ranges::count(result.is_covered, uint8_t{1}));
  if (options.progress) options.progress(1);
  return result;
}

std::vector<uint8_t> coveredTiles(const Lattice& lattice, const Floor& floor, double eye,
                                  std::span<const ViewCell> cells) {
  std::vector<uint8_t> is_covered(floor.tiles.size(), 0);
  const double size = lattice.voxelSize();
  tbb::parallel_for(size_t{0}, cells.size(), [&](size_t i) {
    const glm::dvec3 low = cells[i].center - cells[i].size * 0.5,
                     high = cells[i].center + cells[i].size * 0.5;
    const glm::ivec3 first = voxelAt(lattice, low), last = voxelAt(lattice, high);
    for (int z = first.z; z <= last.z; ++z) {
      auto tile = std::lower_bound(
          floor.tiles.begin(), floor.tiles.end(), std::tie(z, first.x),
          [](const FloorTile& t, const std::tuple<int, int>& at) { return std::tie(t.z, t.x) < at; });
      for (; tile != floor.tiles.end() && tile->z == z && tile->x <= last.x; ++tile) {
        const glm::dvec3 place((tile->x + 0.5) * size, tile->y * size + eye, (tile->z + 0.5) * size);
        const bool is_inside =
            glm::all(glm::lessThanEqual(low, place)) && glm::all(glm::lessThanEqual(place, high));
        if (!is_inside) continue;
        std::atomic_ref<uint8_t> covered(is_covered[size_t(tile - floor.tiles.begin())]);
        covered.store(1, std::memory_order_relaxed);
      }
    }
  });
  return is_covered;
}

}  // namespace sightline
