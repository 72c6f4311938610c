#include "core/place/floor_patches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <queue>
#include <tuple>

#include "core/base/interrupted.h"

namespace sightline {
namespace {

constexpr size_t kPatchesATime = 1 << 14;  // between two looks at `stop`

// Of patches that gain alike the smaller one is better, then the squarer, then that of the lower tile.
bool isWorse(const FloorPatch& a, const FloorPatch& b) {
  const auto orderOf = [](const FloorPatch& p) {
    return std::tuple(p.gain, -int64_t(p.x) * p.z, -std::abs(p.x - p.z), -int64_t(p.tile), p.x);
  };
  return orderOf(a) < orderOf(b);
}

class Patches {
 public:
  Patches(const Floor& floor, const FloorLimits& limits)
      : floor_(floor), limits_(limits), is_covered_(floor.tiles.size(), 0) {}

  // The best patch with this tile as its corner of lowest x and z; gain 0: none is worth it.
  FloorPatch bestFrom(uint32_t tile) const {
    FloorPatch best;
    best.tile = tile;
    std::vector<Column> columns;
    uint32_t first = tile;
    int width = limits_.largest;
    for (int z = 1; z <= limits_.largest && first != FloorTile::kNoTile; ++z) {
      width = addRow(first, z == 1, width, columns);
      if (width < limits_.least) break;
      if (z >= limits_.least) {
        const FloorPatch patch = patchOf(tile, width, z, columns);
        if (isWorse(best, patch)) best = patch;
      }
      first = floor_.tiles[first].next_z;
    }
    if (best.gain < int64_t(limits_.least) * limits_.least) best.gain = 0;
    return best;
  }

  void cover(const FloorPatch& patch) {
    uint32_t first = patch.tile;
    for (int z = 0; z < patch.z; ++z, first = floor_.tiles[first].next_z) {
      uint32_t tile = first;
      for (int x = 0; x < patch.x; ++x, tile = floor_.tiles[tile].next_x) is_covered_[tile] = 1;
    }
  }

 private:
  // The tiles of one x, over the rows so far.
  struct Column {
    uint32_t last = 0;  // tile
    int gain = 0;
    FloorHeights heights;
  };

  bool fits(const FloorHeights& heights) const {
    return heights.high - heights.low <= limits_.eye / 2 && heights.ceiling - heights.high > limits_.eye;
  }

  // How far the rows go on with the one that begins there, at most as far as before.
  int addRow(uint32_t first, bool is_first_row, int width, std::vector<Column>& columns) const {
    FloorHeights all;
    uint32_t next = first;
    for (int x = 0; x < width; ++x) {
      // Both ways to a tile must lead to the same.
      const uint32_t tile = next;
      if (tile == FloorTile::kNoTile) return x;
      if (is_first_row) {
        columns.emplace_back();
      } else if (floor_.tiles[columns[size_t(x)].last].next_z != tile) {
        return x;
      }
      const FloorTile& here = floor_.tiles[tile];
      Column& column = columns[size_t(x)];
      column.heights = column.heights.with({here.y, here.y, here.ceiling});
      column.last = tile;
      column.gain += is_covered_[tile] == 0;
      all = all.with(column.heights);
      if (!fits(all)) return x;
      next = here.next_x;
    }
    return width;
  }

  // Without what gains nothing at its far end.
  FloorPatch patchOf(uint32_t tile, int width, int z, const std::vector<Column>& columns) const {
    while (width > limits_.least && columns[size_t(width - 1)].gain == 0) --width;
    FloorPatch patch{tile, width, z, 0, {}};
    for (int x = 0; x < width; ++x) {
      patch.gain += columns[size_t(x)].gain;
      patch.heights = patch.heights.with(columns[size_t(x)].heights);
    }
    return patch;
  }

  const Floor& floor_;
  const FloorLimits& limits_;
  std::vector<uint8_t> is_covered_;
};

}  // namespace

std::vector<FloorPatch> coverFloor(const Floor& floor, const FloorLimits& limits,
                                   const FloorPatchHooks& hooks) {
  Patches patches(floor, limits);
  std::vector<FloorPatch> from(floor.tiles.size());
  const auto look = [&](double done) {
    if (hooks.stop != nullptr && *hooks.stop) throw Interrupted();
    if (hooks.progress) hooks.progress(done);
  };
  for (size_t begin = 0; begin < from.size(); begin += kPatchesATime) {
    look(0.5 * double(begin) / double(from.size()));
    tbb::parallel_for(begin, std::min(from.size(), begin + kPatchesATime),
                      [&](size_t i) { from[i] = patches.bestFrom(uint32_t(i)); });
  }
  std::erase_if(from, [](const FloorPatch& patch) { return patch.gain == 0; });
  const size_t count = from.size();
  std::priority_queue<FloorPatch, std::vector<FloorPatch>, decltype(&isWorse)> queue(&isWorse,
                                                                                     std::move(from));
  // What a tile's best patch gains only shrinks as others are taken: the first in the queue that still gains
  // as much is the best of all.
  std::vector<FloorPatch> taken;
  for (size_t looks = 0; !queue.empty(); ++looks) {
    if (looks % kPatchesATime == 0) look(1 - 0.5 * double(queue.size()) / double(count));
    const FloorPatch top = queue.top();
    queue.pop();
    const FloorPatch now = patches.bestFrom(top.tile);
    if (now.gain == 0) continue;
    if (isWorse(now, top)) {
      queue.push(now);
      continue;
    }
    patches.cover(now);
    taken.push_back(now);
    queue.push(now);  // others may begin there: it is asked again
  }
  return taken;
}

}  // namespace sightline
