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
#include "core/place/probe_solid.h"

namespace sightline {
namespace {

constexpr uint64_t kTilesATime = 1 << 14;  // between two looks at `stop`
constexpr double kMostInset = 2;           // margins by which a side comes in at most, as in a grid

// In voxels.
struct FloorLimits {
  int largest = 0, least = 0, eye = 0, head = 0, step = 0;
};

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

// Tiles from one on: `x` of them along x and `z` along z.
struct Patch {
  uint32_t tile = 0;
  int x = 0, z = 0;
  int64_t area() const { return int64_t(x) * z; }
};

// Of patches with the same area the squarer one is larger, then that of the lower tile.
bool isSmaller(const Patch& a, const Patch& b) {
  return std::tuple(a.area(), std::min(a.x, a.z), b.tile, a.x) <
         std::tuple(b.area(), std::min(b.x, b.z), a.tile, b.x);
}

// What a box over some tiles must go by.
struct Heights {
  int low = INT32_MAX, high = INT32_MIN;  // of the floor
  int ceiling = INT32_MAX;
  Heights with(const Heights& other) const {
    return {std::min(low, other.low), std::max(high, other.high), std::min(ceiling, other.ceiling)};
  }
};

class Patches {
 public:
  Patches(const Floor& floor, const FloorLimits& limits)
      : floor_(floor),
        limits_(limits),
        is_covered_(floor.tiles.size(), 0),
        before_x_(floor.tiles.size(), FloorTile::kNoTile),
        before_z_(before_x_) {
    for (uint32_t i = 0; i < floor.tiles.size(); ++i) {
      if (floor.tiles[i].next_x != FloorTile::kNoTile) before_x_[floor.tiles[i].next_x] = i;
      if (floor.tiles[i].next_z != FloorTile::kNoTile) before_z_[floor.tiles[i].next_z] = i;
    }
  }

  // The largest patch of tiles that no other covers, with this one as its corner of lowest x and z; area 0:
  // none that is large enough.
  Patch largestFrom(uint32_t tile) const {
    Patch best{tile, 0, 0};
    if (is_covered_[tile] != 0) return best;
    std::vector<Heights> columns;  // over the rows so far, of each x
    std::vector<uint32_t> row;     // the row's tiles
    uint32_t first = tile;
    // Less than the largest, so that patches can still grow by strips too narrow for one of their own.
    const int most = std::max(limits_.largest - limits_.least, limits_.least);
    int width = most;
    for (int z = 1; z <= most && first != FloorTile::kNoTile; ++z) {
      width = addRow(first, z == 1, width, columns, row);
      if (width < limits_.least) break;
      const Patch patch{tile, width, z};
      if (z >= limits_.least && isSmaller(best, patch)) best = patch;
      first = floor_.tiles[first].next_z;
    }
    return best;
  }

  void cover(const Patch& patch) {
    forTiles(patch, [&](uint32_t tile) { is_covered_[tile] = 1; });
  }

  // The patch with rows of tiles that nothing covers taken in on its sides, as long as it fits: strips that
  // are too narrow for a patch of their own.
  Patch grown(Patch patch) {
    forTiles(patch, [&](uint32_t tile) { is_covered_[tile] = 0; });
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      const auto take = [&](uint32_t corner, int x, int z) {
        if (corner == FloorTile::kNoTile || x > limits_.largest || z > limits_.largest) return;
        if (!isFree({corner, x, z})) return;
        patch = {corner, x, z};
        is_changed = true;
      };
      take(patch.tile, patch.x + 1, patch.z);
      take(patch.tile, patch.x, patch.z + 1);
      take(before_x_[patch.tile], patch.x + 1, patch.z);
      take(before_z_[patch.tile], patch.x, patch.z + 1);
    }
    cover(patch);
    return patch;
  }

  Heights heightsOf(const Patch& patch) const {
    Heights heights;
    forTiles(patch, [&](uint32_t tile) { heights = heights.with(heightsAt(tile)); });
    return heights;
  }

 private:
  Heights heightsAt(uint32_t tile) const {
    const FloorTile& t = floor_.tiles[tile];
    return {t.y, t.y, t.ceiling};
  }

  bool fits(const Heights& heights) const {
    return heights.high - heights.low <= limits_.step && heights.ceiling - heights.high > limits_.eye;
  }

  // Whether a patch fits there, of tiles that nothing covers.
  bool isFree(const Patch& patch) const {
    std::vector<Heights> columns;
    std::vector<uint32_t> row;
    uint32_t first = patch.tile;
    for (int z = 0; z < patch.z; ++z, first = floor_.tiles[first].next_z) {
      if (first == FloorTile::kNoTile || addRow(first, z == 0, patch.x, columns, row) < patch.x) return false;
    }
    return true;
  }

  // How far the rows go on with this one, at most as far as before. row: the tiles of the row before, then of
  // this one.
  int addRow(uint32_t first, bool is_first_row, int width, std::vector<Heights>& columns,
             std::vector<uint32_t>& row) const {
    Heights all;
    uint32_t tile = first;
    for (int x = 0; x < width; ++x) {
      // Both ways to a tile must lead to the same.
      const bool is_joined = tile != FloorTile::kNoTile && is_covered_[tile] == 0 &&
                             (is_first_row || floor_.tiles[row[size_t(x)]].next_z == tile);
      if (!is_joined) return x;
      const Heights here = is_first_row ? heightsAt(tile) : columns[size_t(x)].with(heightsAt(tile));
      const Heights with = all.with(here);
      if (!fits(with)) return x;
      all = with;
      if (is_first_row) {
        columns.push_back(here);
        row.push_back(tile);
      } else {
        columns[size_t(x)] = here;
        row[size_t(x)] = tile;
      }
      tile = floor_.tiles[tile].next_x;
    }
    return width;
  }

  template <typename Visit>
  void forTiles(const Patch& patch, Visit&& visit) const {
    uint32_t first = patch.tile;
    for (int z = 0; z < patch.z; ++z, first = floor_.tiles[first].next_z) {
      uint32_t tile = first;
      for (int x = 0; x < patch.x; ++x, tile = floor_.tiles[tile].next_x) visit(tile);
    }
  }

  const Floor& floor_;
  const FloorLimits& limits_;
  std::vector<uint8_t> is_covered_;
  std::vector<uint32_t> before_x_, before_z_;  // the tile of which one is the next
};

// The largest patch, then the largest of what it leaves, and so on. A tile's largest patch only shrinks as
// others are taken, so that one from the top of the queue is the largest of all if it is still whole.
std::vector<Patch> takePatches(Patches& patches, const Floor& floor, const FloorCellOptions& options) {
  std::vector<Patch> from(floor.tiles.size());
  for (size_t begin = 0; begin < from.size(); begin += kTilesATime) {
    if (options.stop != nullptr && *options.stop) throw Interrupted();
    const size_t end = std::min(from.size(), begin + kTilesATime);
    tbb::parallel_for(begin, end, [&](size_t i) { from[i] = patches.largestFrom(uint32_t(i)); });
    if (options.progress) options.progress(0.5 * double(end) / double(from.size()));
  }
  std::erase_if(from, [](const Patch& patch) { return patch.area() == 0; });
  uint64_t left = 0;
  const uint64_t all = from.size();
  std::priority_queue<Patch, std::vector<Patch>, decltype(&isSmaller)> queue(&isSmaller, std::move(from));
  std::vector<Patch> taken;
  while (!queue.empty()) {
    const Patch top = queue.top();
    queue.pop();
    const Patch now = patches.largestFrom(top.tile);
    if (now.x == top.x && now.z == top.z) {
      patches.cover(now);
      taken.push_back(now);
    } else if (now.area() > 0) {
      queue.push(now);
      continue;
    }
    if (++left % kTilesATime != 0) continue;
    if (options.stop != nullptr && *options.stop) throw Interrupted();
    if (options.progress) options.progress(0.5 + 0.5 * double(left) / double(all));
  }
  for (Patch& patch : taken) patch = patches.grown(patch);
  return taken;
}

// The voxels of a patch's box, none if it is too low after all.
VoxelBox boxOf(const Patch& patch, const Heights& heights, const Floor& floor, int head) {
  const FloorTile& corner = floor.tiles[patch.tile];
  const int top = std::min(heights.ceiling, heights.high + head);
  return {{corner.x, heights.high, corner.z}, {corner.x + patch.x - 1, top - 1, corner.z + patch.z - 1}};
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

}  // namespace

FloorOptions floorOptions(const Lattice& lattice, const FloorCellOptions& options) {
  checkLengths(lattice, options);
  const FloorLimits limits = limitsOf(lattice, options);
  return {.head = limits.head, .step = limits.step};
}

FloorCells floorCells(const Scene& scene, const Bvh& bvh, const Lattice& lattice, const Floor& floor,
                      const FloorCellOptions& options) {
  checkLengths(lattice, options);
  const double smallest = std::min(options.least, options.eye);
  const double margin = options.margin.value_or(defaultMargin(sceneBounds(scene), smallest));
  checkMargin(margin, smallest, "cells on the floor");
  const FloorLimits limits = limitsOf(lattice, options);
  Patches patches(floor, limits);
  std::vector<Placed> placed;
  for (const Patch& patch : takePatches(patches, floor, options)) {
    placed.push_back({boxOf(patch, patches.heightsOf(patch), floor, limits.head),
                      floor.tiles[patch.tile].part,
                      {},
                      false});
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
  for (size_t part = 0; part < is_free.size(); ++part)
    result.tiles += is_free[part] ? floor.part_sizes[part] : 0;
  for (Placed& one : placed) {
    if (!one.cell) continue;
    if (!is_free[one.part] || one.is_solid) {
      ++result.in_solid;
      if (is_free[one.part]) result.tiles -= one.tiles();
      continue;
    }
    one.cell->name = fmt::format("floor-{}", result.cells.size() + 1);
    result.inset += one.cell->size != cellOf(lattice, one.box).size;
    result.cells.push_back(std::move(*one.cell));
  }
  result.covered = coveredTiles(lattice, partsOf(floor, is_free), options.eye, result.cells);
  if (options.progress) options.progress(1);
  return result;
}

uint64_t coveredTiles(const Lattice& lattice, const Floor& floor, double eye,
                      std::span<const ViewCell> cells) {
  std::vector<uint8_t> is_covered(floor.tiles.size(), 0);
  const double size = lattice.voxelSize();
  tbb::parallel_for(size_t{0}, cells.size(), [&](size_t i) {
    const glm::dvec3 low = cells[i].center - cells[i].size * 0.5,
                     high = cells[i].center + cells[i].size * 0.5;
    const int first_z = int(std::floor(low.z / size)), last_z = int(std::floor(high.z / size));
    const int first_x = int(std::floor(low.x / size)), last_x = int(std::floor(high.x / size));
    for (int z = first_z; z <= last_z; ++z) {
      const auto begin = std::lower_bound(floor.tiles.begin(), floor.tiles.end(), std::tie(z, first_x),
                                          [](const FloorTile& tile, const std::tuple<int, int>& at) {
                                            return std::tie(tile.z, tile.x) < at;
                                          });
      for (auto tile = begin; tile != floor.tiles.end() && tile->z == z && tile->x <= last_x; ++tile) {
        const glm::dvec3 place((tile->x + 0.5) * size, tile->y * size + eye, (tile->z + 0.5) * size);
        const bool is_inside =
            glm::all(glm::lessThanEqual(low, place)) && glm::all(glm::lessThanEqual(place, high));
        if (!is_inside) continue;
        std::atomic_ref<uint8_t> covered(is_covered[size_t(tile - floor.tiles.begin())]);
        covered.store(1, std::memory_order_relaxed);
      }
    }
  });
  return uint64_t(std::count(is_covered.begin(), is_covered.end(), 1));
}

}  // namespace sightline
