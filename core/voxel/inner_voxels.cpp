#include "core/voxel/inner_voxels.h"

namespace sightline {
namespace {

VoxelBrick innerOfBrick(const VoxelSpace& space, const glm::ivec3& low, uint16_t place) {
  VoxelBrick brick;
  brick.place = place;
  const Share share = space.innerIn(low, 3);
  if (share == Share::kAll) brick.bits.fill(~uint64_t{0});
  if (share != Share::kSome) return brick;
  for (int i = 0; i < kBrickSide * kBrickSide * kBrickSide; ++i) {
    const glm::ivec3 at(i & 7, (i >> 3) & 7, i >> 6);
    if (space.innerIn(low + at, 0) == Share::kAll)
      brick.bits[size_t(at.z)] |= uint64_t{1} << (at.x + 8 * at.y);
  }
  return brick;
}

}  // namespace

VoxelGrid innerVoxels(const VoxelSpace& space) {
  VoxelGrid grid;
  grid.lattice = space.grid().lattice;
  const VoxelBox blocks = space.blocks();
  for (int z = blocks.low.z; z <= blocks.high.z; ++z) {
    for (int y = blocks.low.y; y <= blocks.high.y; ++y) {
      for (int x = blocks.low.x; x <= blocks.high.x; ++x) {
        const glm::ivec3 place(x, y, z);
        if (space.innerInBlock(place) == Share::kNone) continue;
        VoxelBlock block;
        block.place = place;
        for (int i = 0; i < 512; ++i) {
          const glm::ivec3 at = kBrickSide * glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
          const VoxelBrick brick = innerOfBrick(space, place * kBlockSide + at, uint16_t(i));
          if (brick.count() != 0) block.bricks.push_back(brick);
        }
        if (!block.bricks.empty()) grid.blocks.push_back(std::move(block));
      }
    }
  }
  return grid;
}

}  // namespace sightline
