#include "core/voxel/pyramid.h"

#include <algorithm>

namespace sightline {
namespace {

// Of four bytes, every other of eight: bit x of byte y says whether one of the bits 2 x, 2 x + 1 of the bytes
// 2 y, 2 y + 1 is set. In bits 0 .. 3 of bytes 0 .. 3, of 32.
uint32_t halved(uint64_t layer) {
  layer |= layer >> 8;
  layer |= layer >> 1;
  uint32_t result = 0;
  for (int y = 0; y < 4; ++y) {
    uint32_t row = uint32_t(layer >> (16 * y)) & 0x55;
    row = (row | row >> 1) & 0x33;
    row = (row | row >> 2) & 0x0f;
    result |= row << (8 * y);
  }
  return result;
}

// Adds a brick of the finer block to its eighth of a coarser brick.
void addBrick(VoxelBrick& coarse, const VoxelBrick& fine) {
  const int x = fine.place & 1, y = (fine.place >> 3) & 1, z = (fine.place >> 6) & 1;
  for (int layer = 0; layer < 4; ++layer) {
    const uint64_t bits = halved(fine.bits[size_t(2 * layer)] | fine.bits[size_t(2 * layer + 1)]);
    coarse.bits[size_t(4 * z + layer)] |= bits << (4 * x + 32 * y);
  }
}

}  // namespace

void CoarserBlocks::add(const VoxelBlock& block) {
  const glm::ivec3 place(block.place.x >> 1, block.place.y >> 1, block.place.z >> 1);
  if (place.z != layer_) finish();
  layer_ = place.z;
  VoxelBlock& coarse = blocks_[{place.y, place.x}];
  coarse.place = place;
  const glm::ivec3 eighth = (block.place & 1) * 4;  // its lowest brick in the coarser block
  std::array<VoxelBrick, 64> bricks{};              // this block's part: 4 x 4 x 4
  for (const VoxelBrick& fine : block.bricks) {
    const glm::ivec3 at((fine.place & 7) >> 1, ((fine.place >> 3) & 7) >> 1, fine.place >> 7);
    addBrick(bricks[size_t(at.x + 4 * at.y + 16 * at.z)], fine);
  }
  for (int i = 0; i < 64; ++i) {
    if (bricks[size_t(i)].count() == 0) continue;
    const glm::ivec3 at = eighth + glm::ivec3(i & 3, (i >> 2) & 3, i >> 4);
    bricks[size_t(i)].place = uint16_t(at.x + 8 * at.y + 64 * at.z);
    coarse.bricks.push_back(bricks[size_t(i)]);
  }
}

void CoarserBlocks::finish() {
  for (auto& [place, block] : blocks_) {
    std::ranges::sort(block.bricks, {}, &VoxelBrick::place);
    take_(std::move(block));
  }
  blocks_.clear();
}

VoxelGrid coarser(const VoxelGrid& grid) {
  VoxelGrid result;
  result.lattice.exponent = grid.lattice.exponent + 1;
  CoarserBlocks blocks([&](VoxelBlock&& block) { result.blocks.push_back(std::move(block)); });
  for (const VoxelBlock& block : grid.blocks) blocks.add(block);
  blocks.finish();
  return result;
}

bool isRoot(const VoxelGrid& grid) {
  if (grid.blocks.size() > 8) return false;
  const VoxelBox box = boxOf(grid);
  return glm::all(glm::lessThan(box.high - box.low, glm::ivec3(2)));
}

std::vector<VoxelGrid> pyramidOf(VoxelGrid finest) {
  std::vector<VoxelGrid> levels;
  levels.push_back(std::move(finest));
  while (!isRoot(levels.back())) levels.push_back(coarser(levels.back()));
  return levels;
}

}  // namespace sightline
