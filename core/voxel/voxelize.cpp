#include "core/voxel/voxelize.h"

#include <tbb/parallel_for.h>

#include "core/base/interrupted.h"
#include "core/voxel/bin_triangles.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {
namespace {

constexpr int64_t kMostBlocksATime = int64_t(1) << 24;  // lists of a box of blocks, in all

VoxelBox blocksOf(const Bounds& bounds, const Lattice& lattice) {
  const double blocks_a_unit = std::ldexp(1.0, -lattice.exponent) / kBlockSide;
  const glm::dvec3 low = glm::dvec3(bounds.low) * blocks_a_unit,
                   high = glm::dvec3(bounds.high) * blocks_a_unit;
  return {glm::ivec3(glm::ceil(low)) - 1, glm::ivec3(glm::floor(high))};
}

std::vector<VoxelBrick> makeBricks(const Scene& scene, const VoxelizeOptions& options,
                                   const glm::ivec3& place, std::span<const uint32_t> triangles,
                                   BlockBits& bits) {
  bits.clear();
  const glm::ivec3 low = place * kBlockSide;
  const VoxelBox block{low, low + (kBlockSide - 1)};
  const double voxels_a_unit = std::ldexp(1.0, -options.lattice.exponent);
  const auto insert = [&](int y, int z, int first, int last) {
    bits.row(y - low.y, z - low.z) |= rowBits(first - low.x, last - low.x);
  };
  for (const uint32_t id : triangles) {
    const auto corners = inVoxels(scene.corners(id), voxels_a_unit);
    if (options.separation == Separation::kConservative) {
      TriangleRows(corners).visit(block, insert);
    } else {
      SeparatingRows(corners, options.separation).visit(block, insert);
    }
  }
  return bits.bricks();
}

// The layers of blocks from box.low.z on that may be worked on at once.
int layersFrom(const VoxelBox& box, const std::vector<uint64_t>& pairs, int first, uint64_t memory) {
  const int64_t blocks_a_layer = int64_t(box.high.x - box.low.x + 1) * (box.high.y - box.low.y + 1);
  const uint64_t most_pairs = memory / sizeof(uint32_t);
  uint64_t sum = pairs[size_t(first)];
  int layers = 1;
  while (first + layers < int(pairs.size()) && (layers + 1) * blocks_a_layer <= kMostBlocksATime &&
         sum + pairs[size_t(first + layers)] <= most_pairs) {
    sum += pairs[size_t(first + layers++)];
  }
  return layers;
}

}  // namespace

void voxelize(const Scene& scene, const VoxelizeOptions& options,
              const std::function<void(VoxelBlock&&)>& take) {
  const auto make = [&](const BlockTriangles& binned, std::span<const size_t> filled,
                        std::span<VoxelBlock> blocks) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, filled.size(), 1), [&](const auto& range) {
      BlockBits bits;
      for (size_t i = range.begin(); i < range.end(); ++i) {
        blocks[i].bricks = makeBricks(scene, options, blocks[i].place, binned.of(filled[i]), bits);
      }
    });
  };
  const auto bin = [&](const VoxelBox& blocks) { return binTriangles(scene, options.lattice, blocks); };
  voxelizeBy({bin, make}, scene, options, take);
}

void voxelizeBy(const VoxelizeSteps& steps, const Scene& scene, const VoxelizeOptions& options,
                const std::function<void(VoxelBlock&&)>& take) {
  const Bounds bounds = sceneBounds(scene);
  requireFits(options.lattice, bounds);
  const VoxelBox box = blocksOf(bounds, options.lattice);
  const glm::ivec3 size = box.high - box.low + 1;
  const std::vector<uint64_t> pairs = countPairsOfLayers(scene, options.lattice, box);
  uint64_t all_pairs = 0, done_pairs = 0, voxels = 0;
  for (const uint64_t in_layer : pairs) all_pairs += in_layer;
  for (int layer = 0; layer < size.z;) {
    const int layers = layersFrom(box, pairs, layer, options.memory);
    const VoxelBox part{{box.low.x, box.low.y, box.low.z + layer},
                        {box.high.x, box.high.y, box.low.z + layer + layers - 1}};
    const BlockTriangles binned = steps.bin(part);
    std::vector<size_t> filled;
    for (size_t i = 0; i + 1 < binned.first.size(); ++i) {
      if (binned.first[i] != binned.first[i + 1]) filled.push_back(i);
    }
    for (size_t begin = 0; begin < filled.size(); begin += steps.blocks_a_time) {
      if (options.stop != nullptr && *options.stop) throw Interrupted();
      const size_t count = std::min(steps.blocks_a_time, filled.size() - begin);
      const auto now = std::span(filled).subspan(begin, count);
      std::vector<VoxelBlock> blocks(count);
      for (size_t i = 0; i < count; ++i) blocks[i].place = binned.placeOf(now[i]);
      steps.make(binned, now, blocks);
      tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
          const auto triangles = binned.of(now[i]);
          addAttributes(scene, triangles, options.attributes, options.lattice, blocks[i]);
          if (options.with_triangles) blocks[i].triangles.assign(triangles.begin(), triangles.end());
        }
      });
      for (size_t i = 0; i < count; ++i) {
        if (blocks[i].bricks.empty()) continue;
        voxels += blocks[i].count();
        take(std::move(blocks[i]));
      }
      if (options.progress) {
        const double part_done = double(begin + count) / double(filled.size());
        uint64_t part_pairs = 0;
        for (int i = layer; i < layer + layers; ++i) part_pairs += pairs[size_t(i)];
        options.progress((double(done_pairs) + part_done * double(part_pairs)) / double(all_pairs), voxels);
      }
    }
    for (int i = layer; i < layer + layers; ++i) done_pairs += pairs[size_t(i)];
    layer += layers;
  }
}

VoxelGrid voxelize(const Scene& scene, const VoxelizeOptions& options) {
  VoxelGrid grid;
  grid.lattice = options.lattice;
  voxelize(scene, options, [&](VoxelBlock&& block) { grid.blocks.push_back(std::move(block)); });
  return grid;
}

}  // namespace sightline
