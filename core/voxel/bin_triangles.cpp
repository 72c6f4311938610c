#include "core/voxel/bin_triangles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/voxel/voxel_grid.h"

namespace sightline {
namespace {

constexpr uint32_t kTrianglesATask = 4096;

// Calls visit(id, corners in blocks) for all triangles, on many threads.
template <typename Visit>
void visitInBlocks(const Scene& scene, const Lattice& lattice, Visit&& visit) {
  const double blocks_a_unit = std::ldexp(1.0, -lattice.exponent) / kBlockSide;
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.triangleCount(), kTrianglesATask),
                    [&](const auto& range) {
                      scene.visitTriangles(range.begin(), range.end(),
                                           [&](uint32_t id, const std::array<glm::vec3, 3>& corners) {
                                             visit(id, inVoxels(corners, blocks_a_unit));
                                           });
                    });
}

template <typename T>
T addTo(T& counter, T value) {
  return std::atomic_ref<T>(counter).fetch_add(value, std::memory_order_relaxed);
}

}  // namespace

BlockTriangles binTriangles(const Scene& scene, const Lattice& lattice, const VoxelBox& blocks) {
  const glm::ivec3 size = blocks.high - blocks.low + 1;
  const auto placeOf = [&](int x, int y, int z) {
    return size_t(x - blocks.low.x) +
           size_t(size.x) * (size_t(y - blocks.low.y) + size_t(size.y) * size_t(z - blocks.low.z));
  };
  BlockTriangles result;
  result.blocks = blocks;
  result.first.assign(size_t(size.x) * size_t(size.y) * size_t(size.z) + 1, 0);
  visitInBlocks(scene, lattice, [&](uint32_t, const auto& corners) {
    TriangleRows rows(corners);
    rows.visit(blocks, [&](int y, int z, int first, int last) {
      for (int x = first; x <= last; ++x) addTo(result.first[placeOf(x, y, z)], uint64_t{1});
    });
  });
  uint64_t total = 0;
  for (uint64_t& first : result.first) total += std::exchange(first, total);
  result.ids.resize(total);
  std::vector<uint32_t> filled(result.first.size() - 1, 0);
  visitInBlocks(scene, lattice, [&](uint32_t id, const auto& corners) {
    TriangleRows rows(corners);
    rows.visit(blocks, [&](int y, int z, int first, int last) {
      for (int x = first; x <= last; ++x) {
        const size_t place = placeOf(x, y, z);
        result.ids[result.first[place] + addTo(filled[place], uint32_t{1})] = id;
      }
    });
  });
  tbb::parallel_for(size_t{0}, filled.size(), [&](size_t block) {
    if (filled[block] < 2) return;
    const auto first = result.ids.begin() + int64_t(result.first[block]);
    std::sort(first, first + filled[block]);
  });
  return result;
}

std::vector<uint64_t> countPairsOfLayers(const Scene& scene, const Lattice& lattice, const VoxelBox& blocks) {
  std::vector<uint64_t> pairs(size_t(blocks.high.z - blocks.low.z) + 1, 0);
  visitInBlocks(scene, lattice, [&](uint32_t, const auto& corners) {
    const VoxelBox part = overlapOf(blocks, voxelsAround(corners));
    if (part.low.x > part.high.x || part.low.y > part.high.y) return;
    const uint64_t in_layer = uint64_t(part.high.x - part.low.x + 1) * uint64_t(part.high.y - part.low.y + 1);
    for (int z = part.low.z; z <= part.high.z; ++z) addTo(pairs[size_t(z - blocks.low.z)], in_layer);
  });
  return pairs;
}

}  // namespace sightline
