#include "core/bound/blocked_space.h"

#include <fmt/core.h>

#include "core/base/error.h"

namespace sightline {
namespace {

// Bits x + 8 y of a rectangle, both ends with it.
uint64_t squareBits(int low_x, int high_x, int low_y, int high_y) {
  const uint64_t row = (0xffu >> (7 - high_x)) & (0xffu << low_x) & 0xffu;
  const uint64_t rows = (~uint64_t{0} >> (8 * (7 - high_y))) & (~uint64_t{0} << (8 * low_y));
  return (row * 0x0101010101010101u) & rows;
}

// Whether all voxels of a box in a brick are in it.
bool holdsBox(const std::array<uint64_t, 8>& brick, const glm::ivec3& low, const glm::ivec3& high) {
  const uint64_t square = squareBits(low.x, high.x, low.y, high.y);
  for (int z = low.z; z <= high.z; ++z) {
    if ((brick[size_t(z)] & square) != square) return false;
  }
  return true;
}

bool bitOf(const uint64_t* words, const glm::ivec3& at) {
  return ((words[at.z] >> (at.x + 8 * at.y)) & 1) != 0;
}

}  // namespace

void OpenBlock::assign(const PackedBlock& packed) {
  all = packed.all;
  some = packed.some;
  size_t next = 0;
  for (int z = 0; z < 8; ++z) {
    for (int xy = 0; xy < 64; ++xy) {
      const bool full = ((all[size_t(z)] >> xy) & 1) != 0, mixed = ((some[size_t(z)] >> xy) & 1) != 0;
      Brick& brick = bits[size_t(64 * z + xy)];
      if (mixed) {
        brick = packed.bits[next++];
      } else {
        brick.fill(full ? ~uint64_t{0} : 0);
      }
    }
  }
}

void OpenBlock::insert(const glm::ivec3& low, int side) {
  if (side >= 8) {
    const glm::ivec3 first = low >> 3, last = first + side / 8 - 1;
    const uint64_t square = squareBits(first.x, last.x, first.y, last.y);
    for (int z = first.z; z <= last.z; ++z) {
      all[size_t(z)] |= square;
      some[size_t(z)] &= ~square;
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) bits[size_t(64 * z + 8 * y + x)].fill(~uint64_t{0});
      }
    }
    return;
  }
  const glm::ivec3 at = low >> 3, in = low & 7;
  Brick& brick = bits[size_t(64 * at.z + 8 * at.y + at.x)];
  const uint64_t square = squareBits(in.x, in.x + side - 1, in.y, in.y + side - 1);
  for (int z = in.z; z < in.z + side; ++z) brick[size_t(z)] |= square;
  uint64_t words = ~uint64_t{0};
  for (const uint64_t word : brick) words &= word;
  const uint64_t bit = uint64_t{1} << (at.x + 8 * at.y);
  if (words == ~uint64_t{0}) {
    all[size_t(at.z)] |= bit;
    some[size_t(at.z)] &= ~bit;
  } else {
    some[size_t(at.z)] |= bit;
  }
}

PackedBlock OpenBlock::packed() const {
  PackedBlock result;
  result.all = all;
  result.some = some;
  for (int z = 0; z < 8; ++z) {
    for (int xy = 0; xy < 64; ++xy) {
      if (((some[size_t(z)] >> xy) & 1) != 0) result.bits.push_back(bits[size_t(64 * z + xy)]);
    }
  }
  return result;
}

bool OpenBlock::isFull() const {
  uint64_t words = ~uint64_t{0};
  for (const uint64_t word : all) words &= word;
  return words == ~uint64_t{0};
}

BlockedSpace::BlockedSpace(const VoxelBox& blocks) : blocks_(blocks), size_(blocks.high - blocks.low + 1) {
  const uint64_t count = uint64_t(size_.x) * uint64_t(size_.y) * uint64_t(size_.z);
  if (count > kMostBlocks) {
    throw Error(fmt::format("{} blocks of {} voxels a side are more than {}: take larger voxels", count,
                            kBlockSide, kMostBlocks));
  }
  entries_.assign(size_t(count), kNone);
}

Share BlockedSpace::share(const glm::ivec3& block) const {
  const uint32_t at = entry(block);
  return at == kNone ? Share::kNone : at == kAll ? Share::kAll : Share::kSome;
}

bool BlockedSpace::contains(const glm::ivec3& voxel) const {
  const uint32_t at = entry(voxel >> 6);
  return at >= kPacked ? packed_[at - kPacked].contains(voxel & 63) : at == kAll;
}

uint64_t BlockedSpace::count() const {
  uint64_t sum = 0;
  for (const uint32_t at : entries_) {
    sum += at == kNone ? 0 : at == kAll ? uint64_t(64) * 64 * 64 : packed_[at - kPacked].count();
  }
  return sum;
}

void BlockedSpace::set(const glm::ivec3& block, Share share, PackedBlock&& packed) {
  uint32_t& at = entries_[indexOf(block)];
  if (share != Share::kSome) {
    if (at >= kPacked) {
      packed_[at - kPacked] = {};
      free_.push_back(at - kPacked);
    }
    at = share == Share::kAll ? kAll : kNone;
    return;
  }
  if (at < kPacked) {
    if (free_.empty()) {
      free_.push_back(uint32_t(packed_.size()));
      packed_.emplace_back();
    }
    at = kPacked + free_.back();
    free_.pop_back();
  }
  packed_[at - kPacked] = std::move(packed);
}

void BlockedView::goTo(const glm::ivec3& block) {
  if (block == at_) return;
  at_ = block;
  if (own_ != nullptr && block == own_place_) {
    kind_ = Kind::kOwn;
    all_ = own_->all.data();
    some_ = own_->some.data();
    bits_ = own_->bits.data();
    return;
  }
  const uint32_t entry = space_.entry(block);
  if (entry < BlockedSpace::kPacked) {
    kind_ = entry == BlockedSpace::kAll ? Kind::kAll : Kind::kNone;
    return;
  }
  kind_ = Kind::kPacked;
  const PackedBlock& packed = space_.packed_[entry - BlockedSpace::kPacked];
  all_ = packed.all.data();
  some_ = packed.some.data();
  bits_ = packed.bits.data();
}

// Of a brick of the block looked at, of which some is in the set.
const std::array<uint64_t, 8>* BlockedView::brickAt(const glm::ivec3& brick) const {
  if (kind_ == Kind::kOwn) return bits_ + 64 * brick.z + 8 * brick.y + brick.x;
  return bits_ + placeOfBits(some_, brick);
}

BlockedView::Cube BlockedView::cubeAt(const glm::ivec3& voxel) {
  goTo(voxel >> 6);
  if (kind_ == Kind::kNone || kind_ == Kind::kAll) return {kind_ == Kind::kAll, kBlockSide};
  const glm::ivec3 brick = (voxel & 63) >> 3;
  if (bitOf(all_, brick)) return {true, kBrickSide};
  if (!bitOf(some_, brick)) return {false, kBrickSide};
  return {bitOf(brickAt(brick)->data(), voxel & 7), 1};
}

bool BlockedView::covers(int axis, const VoxelBox& layer) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  glm::ivec3 brick = layer.low >> 3;
  const int first_u = brick[u], last_u = layer.high[u] >> 3, last_v = layer.high[v] >> 3;
  for (; brick[v] <= last_v; ++brick[v]) {
    for (brick[u] = first_u; brick[u] <= last_u; ++brick[u]) {
      goTo(brick >> 3);
      if (kind_ == Kind::kAll) continue;
      if (kind_ == Kind::kNone) return false;
      const glm::ivec3 in_block = brick & 7;
      if (bitOf(all_, in_block)) continue;
      if (!bitOf(some_, in_block)) return false;
      const glm::ivec3 low = glm::max(layer.low - 8 * brick, 0), high = glm::min(layer.high - 8 * brick, 7);
      if (!holdsBox(*brickAt(in_block), low, high)) return false;
    }
  }
  return true;
}

}  // namespace sightline
