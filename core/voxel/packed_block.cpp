#include "core/voxel/packed_block.h"

namespace sightline {
namespace {

// The bits x + 8 y of a cube of that side.
uint64_t squareBits(int x, int y, int side) {
  const uint64_t row = (uint64_t{1} << side) - 1;  // side <= 8
  uint64_t square = 0;
  for (int i = 0; i < side; ++i) square |= row << (x + 8 * (y + i));
  return square;
}

// A cube's part of eight words of 64 bits, word z, bit x + 8 y.
Share shareOfWords(const std::array<uint64_t, 8>& words, const glm::ivec3& low, int side) {
  const uint64_t square = squareBits(low.x, low.y, side);
  uint64_t any = 0, all = ~uint64_t{0};
  for (int z = low.z; z < low.z + side; ++z) {
    any |= words[size_t(z)];
    all &= words[size_t(z)];
  }
  return (all & square) == square ? Share::kAll : (any & square) == 0 ? Share::kNone : Share::kSome;
}

}  // namespace

Share PackedBlock::shareOf(const glm::ivec3& low, int level) const {
  const glm::ivec3 brick = low >> 3;
  if (level >= 3) {
    const int side = 1 << (level - 3);
    const Share whole = shareOfWords(all, brick, side);
    if (whole != Share::kNone) return whole;
    return shareOfWords(some, brick, side) == Share::kNone ? Share::kNone : Share::kSome;
  }
  const int bit = brick.x + 8 * brick.y;
  if (((all[size_t(brick.z)] >> bit) & 1) != 0) return Share::kAll;
  if (((some[size_t(brick.z)] >> bit) & 1) == 0) return Share::kNone;
  return shareOfWords(bits[placeOfBits(some.data(), brick)], low & 7, 1 << level);
}

uint64_t PackedBlock::count() const {
  uint64_t sum = 0;
  for (const uint64_t word : all) sum += 512 * uint64_t(std::popcount(word));
  for (const Brick& brick : bits) {
    for (const uint64_t word : brick) sum += uint64_t(std::popcount(word));
  }
  return sum;
}

void PackedBlock::addTo(BlockBits& block) const {
  size_t next = 0;
  for (int bz = 0; bz < 8; ++bz) {
    for (int by = 0; by < 8; ++by) {
      uint64_t whole = 0;
      for (int bx = 0; bx < 8; ++bx) {
        const uint64_t bit = uint64_t{1} << (bx + 8 * by);
        if ((all[size_t(bz)] & bit) != 0) whole |= uint64_t{0xff} << (8 * bx);
        if ((some[size_t(bz)] & bit) == 0) continue;
        block.insert({bx, by, bz}, bits[next++]);
      }
      if (whole == 0) continue;
      for (int z = 0; z < 8; ++z) {
        for (int y = 0; y < 8; ++y) block.row(8 * by + y, 8 * bz + z) |= whole;
      }
    }
  }
}

PackedBlock packBlock(const BlockBits& block) {
  PackedBlock result;
  for (int bz = 0; bz < 8; ++bz) {
    for (int by = 0; by < 8; ++by) {
      uint64_t any = 0, all = ~uint64_t{0};
      for (int z = 0; z < 8; ++z) {
        for (int y = 0; y < 8; ++y) {
          any |= block.row(8 * by + y, 8 * bz + z);
          all &= block.row(8 * by + y, 8 * bz + z);
        }
      }
      for (int bx = 0; bx < 8; ++bx) {
        const uint64_t bit = uint64_t{1} << (bx + 8 * by);
        if (((all >> (8 * bx)) & 0xff) == 0xff) {
          result.all[size_t(bz)] |= bit;
        } else if (((any >> (8 * bx)) & 0xff) != 0) {
          result.some[size_t(bz)] |= bit;
          result.bits.push_back(block.brick({bx, by, bz}));
        }
      }
    }
  }
  return result;
}

}  // namespace sightline
