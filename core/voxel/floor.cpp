#include "core/voxel/floor.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/base/error.h"
#include "core/base/interrupted.h"

namespace sightline {
namespace {

constexpr size_t kMostTiles = size_t(1) << 30;
constexpr int kFarUp = 1 << 29;  // a ceiling that is not there

// Looks at a stack of blocks from above to below.
class StackScan {
 public:
  StackScan(const VoxelSpace& space, int head)
      : space_(space), head_(head), ceiling_(size_t(kBlockSide) * kBlockSide) {}

  // Tiles of the blocks (x, ., z), in the order of Floor.
  std::vector<FloorTile> scan(int x, int z) {
    std::vector<FloorTile> tiles;
    const VoxelBox& blocks = space_.blocks();
    const bool is_open = space_.outside() == VoxelState::kFree;
    above_.fill(is_open ? ~uint64_t{0} : 0);
    std::fill(ceiling_.begin(), ceiling_.end(), is_open ? kFarUp : (blocks.high.y + 1) * kBlockSide);
    for (int y = blocks.high.y; y >= blocks.low.y; --y) {
      space_.bitsOf({x, y, z}, free_, surface_);
      for (int row = kBlockSide - 1; row >= 0; --row) {
        for (int k = 0; k < kBlockSide; ++k) scanRow({x, y, z}, row, k, tiles);
      }
    }
    std::sort(tiles.begin(), tiles.end(), [](const FloorTile& a, const FloorTile& b) {
      return std::tie(a.z, a.x, a.y) < std::tie(b.z, b.x, b.y);
    });
    return tiles;
  }

 private:
  void scanRow(const glm::ivec3& block, int row, int k, std::vector<FloorTile>& tiles) {
    const uint64_t free = free_.row(row, k), above = above_[size_t(k)];
    const int y = block.y * kBlockSide + row;
    for (uint64_t bits = above & surface_.row(row, k); bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      const int ceiling = ceiling_[size_t(i + kBlockSide * k)];
      if (ceiling - (y + 1) < head_) continue;
      tiles.push_back({block.x * kBlockSide + i, block.z * kBlockSide + k, y + 1, ceiling});
    }
    for (uint64_t bits = free & ~above; bits != 0; bits &= bits - 1) {
      ceiling_[size_t(std::countr_zero(bits) + kBlockSide * k)] = y + 1;
    }
    above_[size_t(k)] = free;
  }

  const VoxelSpace& space_;
  int head_;
  BlockBits free_, surface_;
  std::array<uint64_t, kBlockSide> above_{};  // free voxels of the layer above, word z, bit x
  std::vector<int> ceiling_;                  // of the free run that is open, x + 64 z
};

uint32_t tileAt(const Floor& floor, int x, int z, int low_y, int high_y) {
  const auto found = std::lower_bound(floor.tiles.begin(), floor.tiles.end(), std::tie(z, x, low_y),
                                      [](const FloorTile& tile, const std::tuple<int, int, int>& at) {
                                        return std::tie(tile.z, tile.x, tile.y) < at;
                                      });
  if (found == floor.tiles.end() || found->z != z || found->x != x || found->y > high_y) {
    return FloorTile::kNoTile;
  }
  return uint32_t(found - floor.tiles.begin());
}

uint32_t neighbour(const Floor& floor, const FloorTile& tile, int x, int z, const FloorOptions& options) {
  const uint32_t next = tileAt(floor, x, z, tile.y - options.step, tile.y + options.step);
  if (next == FloorTile::kNoTile) return next;
  const FloorTile& other = floor.tiles[next];
  const int room = std::min(tile.ceiling, other.ceiling) - std::max(tile.y, other.y);
  return room >= options.head ? next : FloorTile::kNoTile;
}

// Whether a column next to the tile's is free from head to more than a step below it.
bool isAtEdge(const VoxelSpace& space, const FloorTile& tile, const FloorOptions& options) {
  for (int i = 0; i < 9; ++i) {
    if (i == 4) continue;
    glm::ivec3 at(tile.x + i % 3 - 1, tile.y - 1, tile.z + i / 3 - 1);  // most often met here
    bool is_free = space.state(at) == VoxelState::kFree;
    for (at.y = tile.y - 1 - options.step; is_free && at.y < tile.y + options.head; ++at.y) {
      is_free = space.state(at) == VoxelState::kFree;
    }
    if (is_free) return true;
  }
  return false;
}

void leaveOutEdges(const VoxelSpace& space, const FloorOptions& options, std::vector<FloorTile>& tiles) {
  std::vector<uint8_t> is_at_edge(tiles.size());
  tbb::parallel_for(size_t{0}, tiles.size(),
                    [&](size_t i) { is_at_edge[i] = isAtEdge(space, tiles[i], options); });
  size_t kept = 0;
  for (size_t i = 0; i < tiles.size(); ++i) {
    if (is_at_edge[i] == 0) tiles[kept++] = tiles[i];
  }
  tiles.resize(kept);
}

// Numbers the parts.
void joinParts(Floor& floor) {
  std::vector<uint32_t> parent(floor.tiles.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (uint32_t i = 0; i < floor.tiles.size(); ++i) {
    for (const uint32_t next : {floor.tiles[i].next_x, floor.tiles[i].next_z}) {
      if (next == FloorTile::kNoTile) continue;
      const uint32_t a = rootOf(i), b = rootOf(next);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  floor.part_sizes.clear();
  for (uint32_t i = 0; i < floor.tiles.size(); ++i) {
    const uint32_t root = rootOf(i);  // the part's first tile: it has its number already
    if (root == i) {
      floor.tiles[i].part = uint32_t(floor.part_sizes.size());
      floor.part_sizes.push_back(0);
    } else {
      floor.tiles[i].part = floor.tiles[root].part;
    }
    ++floor.part_sizes[floor.tiles[i].part];
  }
}

}  // namespace

Floor findFloor(const VoxelSpace& space, const FloorOptions& options) {
  const VoxelBox& blocks = space.blocks();
  Floor floor;
  const size_t count_x = size_t(std::max(blocks.high.x - blocks.low.x + 1, 0));
  for (int z = blocks.low.z; z <= blocks.high.z; ++z) {
    if (options.stop != nullptr && *options.stop) throw Interrupted();
    std::vector<std::vector<FloorTile>> stacks(count_x);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count_x, 1), [&](const auto& range) {
      StackScan scan(space, options.head);
      for (size_t i = range.begin(); i < range.end(); ++i) {
        stacks[i] = scan.scan(blocks.low.x + int(i), z);
      }
    });
    // Rows of tiles along x go on from stack to stack.
    std::vector<size_t> next(count_x, 0);
    for (int row = z * kBlockSide; row < (z + 1) * kBlockSide; ++row) {
      for (size_t i = 0; i < count_x; ++i) {
        while (next[i] < stacks[i].size() && stacks[i][next[i]].z == row) {
          floor.tiles.push_back(stacks[i][next[i]++]);
        }
      }
    }
    if (floor.tiles.size() > kMostTiles) throw Error("the floor is too large: take larger voxels");
    if (options.progress) {
      options.progress(double(z - blocks.low.z + 1) / double(blocks.high.z - blocks.low.z + 1));
    }
  }
  leaveOutEdges(space, options, floor.tiles);
  tbb::parallel_for(size_t{0}, floor.tiles.size(), [&](size_t i) {
    FloorTile& tile = floor.tiles[i];
    tile.next_x = neighbour(floor, tile, tile.x + 1, tile.z, options);
    tile.next_z = neighbour(floor, tile, tile.x, tile.z + 1, options);
  });
  joinParts(floor);
  return floor;
}

uint32_t tileBelow(const Floor& floor, const VoxelSpace& space, const glm::ivec3& voxel) {
  glm::ivec3 at = voxel;
  const int lowest = space.blocks().low.y * kBlockSide;
  at.y = std::min(at.y, (space.blocks().high.y + 1) * kBlockSide);
  while (at.y >= lowest && space.state(at) == VoxelState::kFree) --at.y;
  return tileAt(floor, at.x, at.z, at.y + 1, at.y + 1);
}

Floor tilesOf(const Floor& floor, const std::function<bool(uint32_t tile)>& keep) {
  Floor kept;
  std::vector<uint32_t> place(floor.tiles.size(), FloorTile::kNoTile);
  for (uint32_t i = 0; i < floor.tiles.size(); ++i) {
    if (!keep(i)) continue;
    place[i] = uint32_t(kept.tiles.size());
    kept.tiles.push_back(floor.tiles[i]);
  }
  for (FloorTile& tile : kept.tiles) {
    if (tile.next_x != FloorTile::kNoTile) tile.next_x = place[tile.next_x];
    if (tile.next_z != FloorTile::kNoTile) tile.next_z = place[tile.next_z];
  }
  joinParts(kept);
  return kept;
}

}  // namespace sightline
