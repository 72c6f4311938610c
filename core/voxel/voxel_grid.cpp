#include "core/voxel/voxel_grid.h"

#include <algorithm>

namespace sightline {
namespace {

uint64_t keyOf(const glm::ivec3& place) {
  const auto part = [](int value) { return uint64_t(uint32_t(value) & 0x1fffff); };
  return part(place.x) | part(place.y) << 21 | part(place.z) << 42;
}

}  // namespace

VoxelBox boxOf(const VoxelBlock& block) {
  VoxelBox box{glm::ivec3(kBlockSide), glm::ivec3(-1)};
  for (const VoxelBrick& brick : block.bricks) {
    const glm::ivec3 low(8 * (brick.place & 7), 8 * ((brick.place >> 3) & 7), 8 * (brick.place >> 6));
    uint64_t all = 0;
    for (int z = 0; z < 8; ++z) {
      const uint64_t layer = brick.bits[size_t(z)];
      if (layer == 0) continue;
      all |= layer;
      box.low.z = std::min(box.low.z, low.z + z);
      box.high.z = std::max(box.high.z, low.z + z);
    }
    uint64_t columns = all;
    for (const int shift : {32, 16, 8}) columns |= columns >> shift;
    columns &= 0xff;
    box.low.y = std::min(box.low.y, low.y + std::countr_zero(all) / 8);
    box.high.y = std::max(box.high.y, low.y + 7 - std::countl_zero(all) / 8);
    box.low.x = std::min(box.low.x, low.x + std::countr_zero(columns));
    box.high.x = std::max(box.high.x, low.x + 63 - std::countl_zero(columns));
  }
  const glm::ivec3 origin = block.place * kBlockSide;
  return {origin + box.low, origin + box.high};
}

VoxelBox boxOf(const VoxelGrid& grid) {
  if (grid.blocks.empty()) return {};
  VoxelBox box = boxOf(grid.blocks.front());
  for (const VoxelBlock& block : grid.blocks) {
    const VoxelBox part = boxOf(block);
    box = {glm::min(box.low, part.low), glm::max(box.high, part.high)};
  }
  return box;
}

VoxelLookup::VoxelLookup(const VoxelGrid& grid) : grid_(&grid) {
  places_.reserve(grid.blocks.size());
  for (size_t i = 0; i < grid.blocks.size(); ++i) places_.emplace(keyOf(grid.blocks[i].place), uint32_t(i));
}

const VoxelBlock* VoxelLookup::block(const glm::ivec3& place) const {
  const auto found = places_.find(keyOf(place));
  return found == places_.end() ? nullptr : &grid_->blocks[found->second];
}

bool VoxelLookup::contains(const glm::ivec3& voxel) const {
  const VoxelBlock* found = block({voxel.x >> 6, voxel.y >> 6, voxel.z >> 6});
  if (found == nullptr) return false;
  const glm::ivec3 in_block = voxel & 63;
  const int place = (in_block.x >> 3) + 8 * (in_block.y >> 3) + 64 * (in_block.z >> 3);
  const auto brick = std::lower_bound(found->bricks.begin(), found->bricks.end(), place,
                                      [](const VoxelBrick& b, int wanted) { return b.place < wanted; });
  return brick != found->bricks.end() && brick->place == place &&
         brick->contains(in_block.x & 7, in_block.y & 7, in_block.z & 7);
}

std::vector<VoxelBrick> BlockBits::bricks() const {
  std::vector<VoxelBrick> result;
  for (int bz = 0; bz < 8; ++bz) {
    for (int by = 0; by < 8; ++by) {
      uint64_t any = 0;
      for (int z = 0; z < 8; ++z) {
        for (int y = 0; y < 8; ++y) any |= row(8 * by + y, 8 * bz + z);
      }
      for (int bx = 0; any != 0 && bx < 8; ++bx) {
        if (((any >> (8 * bx)) & 0xff) == 0) continue;
        result.push_back({uint16_t(bx + 8 * by + 64 * bz), brick({bx, by, bz})});
      }
    }
  }
  return result;
}

void BlockBits::insert(std::span<const VoxelBrick> bricks) {
  for (const VoxelBrick& brick : bricks) {
    insert({brick.place & 7, (brick.place >> 3) & 7, brick.place >> 6}, brick.bits);
  }
}

std::array<uint64_t, 8> BlockBits::brick(const glm::ivec3& place) const {
  std::array<uint64_t, 8> bits{};
  for (int z = 0; z < 8; ++z) {
    for (int y = 0; y < 8; ++y) {
      bits[size_t(z)] |= ((row(8 * place.y + y, 8 * place.z + z) >> (8 * place.x)) & 0xff) << (8 * y);
    }
  }
  return bits;
}

void BlockBits::insert(const glm::ivec3& place, const std::array<uint64_t, 8>& bits) {
  for (int z = 0; z < 8; ++z) {
    for (int y = 0; y < 8; ++y) {
      row(8 * place.y + y, 8 * place.z + z) |= ((bits[size_t(z)] >> (8 * y)) & 0xff) << (8 * place.x);
    }
  }
}

}  // namespace sightline
