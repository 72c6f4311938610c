#pragma once
#include <atomic>
#include <functional>
#include <vector>

#include "core/voxel/floor.h"

namespace sightline {

/// In voxels.
struct FloorLimits {
  int largest = 0, least = 0;  ///< sides of a patch
  int eye = 0, head = 0, step = 0;
};

/// Of a patch's tiles.
struct FloorHeights {
  int low = INT32_MAX, high = INT32_MIN;
  int ceiling = INT32_MAX;

  FloorHeights with(const FloorHeights& other) const {
    return {std::min(low, other.low), std::max(high, other.high), std::min(ceiling, other.ceiling)};
  }
};

/// Tiles that are neighbours, without a gap: from one on, `x` of them along x and `z` along z.
struct FloorPatch {
  uint32_t tile = 0;  ///< of lowest x and z
  int x = 0, z = 0;
  int64_t gain = 0;  ///< tiles that no patch before it covers
  FloorHeights heights;
};

struct FloorPatchHooks {
  std::function<void(double done)> progress = {};  ///< on the caller's thread, 0 to 1, ascending
  const std::atomic<bool>* stop = nullptr;         ///< ends it with Interrupted when it becomes true
};

/// Patches over the floor, with sides from least to largest, that are at most half of `eye` from lowest to
/// highest tile and have more than `eye` between highest tile and lowest ceiling. Each is one that covers
/// most of what those before it leave, of such the smallest, as long as that is as much as the least patch
/// has. The same on any number of threads.
///
/// Based on: the greedy rule for covers by sets, V. Chvatal, A Greedy Heuristic for the Set-Covering Problem,
/// 1979, evaluated lazily: M. Minoux, Accelerated greedy algorithms for maximizing submodular set functions,
/// 1978.
std::vector<FloorPatch> coverFloor(const Floor& floor, const FloorLimits& limits,
                                   const FloorPatchHooks& hooks);

}  // namespace sightline
