#include "core/voxel/block_flood.h"

namespace sightline {
namespace {

// All bits of `free` that are next to each other and to one of `bits`.
uint64_t fillRow(uint64_t bits, uint64_t free) {
  uint64_t up = bits, down = bits, up_free = free, down_free = free;
  for (int step = 1; step < kBlockSide; step *= 2) {
    up |= up_free & (up << step);
    up_free &= up_free << step;
    down |= down_free & (down >> step);
    down_free &= down_free >> step;
  }
  return up | down;
}

struct BlockFlood {
  const BlockBits& free;
  BlockBits& reached;
  std::array<uint64_t, kBlockSide>& dirty;

  void pass(int y, int z, uint64_t from) {
    const uint64_t added = from & free.row(y, z) & ~reached.row(y, z);
    if (added == 0) return;
    reached.row(y, z) |= added;
    dirty[size_t(z)] |= uint64_t{1} << y;
  }

  void visit(int y, int z) {
    dirty[size_t(z)] &= ~(uint64_t{1} << y);
    const uint64_t row = fillRow(reached.row(y, z), free.row(y, z));
    reached.row(y, z) = row;
    if (y > 0) pass(y - 1, z, row);
    if (y + 1 < kBlockSide) pass(y + 1, z, row);
    if (z > 0) pass(y, z - 1, row);
    if (z + 1 < kBlockSide) pass(y, z + 1, row);
  }
};

}  // namespace

BlockSide sideOf(const BlockBits& block, int side) {
  BlockSide result{};
  const int at = (side & 1) != 0 ? kBlockSide - 1 : 0;
  for (int i = 0; i < kBlockSide; ++i) {
    if (side >= 4) {
      result[size_t(i)] = block.row(i, at);
    } else if (side >= 2) {
      result[size_t(i)] = block.row(at, i);
    } else {
      for (int y = 0; y < kBlockSide; ++y) result[size_t(i)] |= ((block.row(y, i) >> at) & 1) << y;
    }
  }
  return result;
}

void addToSide(BlockBits& block, int side, const BlockSide& bits) {
  const int at = (side & 1) != 0 ? kBlockSide - 1 : 0;
  for (int i = 0; i < kBlockSide; ++i) {
    const uint64_t word = bits[size_t(i)];
    if (side >= 4) {
      block.row(i, at) |= word;
    } else if (side >= 2) {
      block.row(at, i) |= word;
    } else if (word != 0) {
      for (int y = 0; y < kBlockSide; ++y) block.row(y, i) |= ((word >> y) & 1) << at;
    }
  }
}

void floodBlock(const BlockBits& free, BlockBits& reached, std::array<uint64_t, kBlockSide>& dirty) {
  BlockFlood flood{free, reached, dirty};
  // Upwards, then downwards: a row passes on to those that come next in the same sweep.
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (int z = 0; z < kBlockSide; ++z) {
      while (dirty[size_t(z)] != 0) {
        flood.visit(std::countr_zero(dirty[size_t(z)]), z);
        is_changed = true;
      }
    }
    for (int z = kBlockSide - 1; z >= 0; --z) {
      while (dirty[size_t(z)] != 0) {
        flood.visit(63 - std::countl_zero(dirty[size_t(z)]), z);
        is_changed = true;
      }
    }
  }
}

}  // namespace sightline
