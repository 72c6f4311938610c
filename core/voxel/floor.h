#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/voxel/voxel_space.h"

namespace sightline {

/// A voxel on which one stands: free, and a triangle meets the one below.
struct FloorTile {
  int x = 0, z = 0;
  int y = 0;        ///< of the lowest free voxel
  int ceiling = 0;  ///< of the first voxel above it that is not free, or so far up that it does not matter
  uint32_t next_x = kNoTile, next_z = kNoTile;  ///< the tile a step away in x + 1, z + 1
  uint32_t part = 0;

  static constexpr uint32_t kNoTile = ~uint32_t{0};
};

struct FloorOptions {
  int head = 0;  ///< voxels that must be free above the floor, 1 or more
  int step = 0;  ///< voxels that one climbs at a time at most, 0 to half of head: then a tile has one
                 ///< neighbour in a direction at most
  std::function<void(double done)> progress = {};  ///< on the caller's thread, 0 to 1, ascending
  const std::atomic<bool>* stop = nullptr;         ///< ends it with Interrupted when it becomes true
};

/// Where one walks.
struct Floor {
  std::vector<FloorTile> tiles;      ///< z, then x, then y ascending
  std::vector<uint64_t> part_sizes;  ///< tiles of each part; parts in the order of their first tiles
};

/// All tiles: free voxels of the space on a voxel that a triangle meets, with `head` free voxels from it up,
/// but those at an edge: next to one of the eight columns around is free from there down to more than `step`
/// below, so that the floor may end within the tile. Two are neighbours if they share a side seen from above,
/// are at most `step` apart in height, and `head` voxels fit between the higher floor and the lower ceiling;
/// a part is what neighbours join. Voxels keep their word: the floor lies up to a voxel below a tile, and not
/// above. Where the scene has no floor, there are no tiles. The same on any number of threads. Throws Error
/// for more than 2^30 tiles, and Interrupted.
Floor findFloor(const VoxelSpace& space, const FloorOptions& options);

/// The tile that one who falls from a free voxel comes to stand on; kNoTile: none.
uint32_t tileBelow(const Floor& floor, const VoxelSpace& space, const glm::ivec3& voxel);

/// Only the tiles, by their place in the floor, for which `keep` is true.
Floor tilesOf(const Floor& floor, const std::function<bool(uint32_t tile)>& keep);

}  // namespace sightline
