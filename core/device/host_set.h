#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/shared/set.h"

namespace sightline {

/// Which capacity the hash set has to begin with; it doubles as needed.
inline constexpr uint32_t kFirstHashCapacity = 1u << 16;

/// The set of found triangles in host memory (core/shared/set.h), array or hash set.
class HostSet {
 public:
  HostSet(uint32_t triangle_count, bool hash)
      : capacity_(hash ? kFirstHashCapacity : 0),
        keys_(capacity_, kNoTriangle),
        winner_(hash ? capacity_ : triangle_count, kSlotEmpty),
        fresh_((triangle_count + 31) / 32, 0u) {}

  SetRef ref() { return {keys_.data(), winner_.data(), fresh_.data(), &overflow_, capacity_}; }
  bool isHash() const { return capacity_ > 0; }
  uint32_t capacity() const { return capacity_; }
  /// Words of 32 triangles each: those that were new in this batch.
  std::vector<uint32_t>& fresh() { return fresh_; }

  /// Whether a launch found no room; lowers the flag.
  bool takeOverflow() { return std::exchange(overflow_, 0u) != 0; }

  /// Makes the hash set `factor` times as large, keeping its contents.
  void grow(uint32_t factor) {
    HostSet larger(0, true);
    larger.capacity_ = capacity_ * factor;
    larger.keys_.assign(larger.capacity_, kNoTriangle);
    larger.winner_.assign(larger.capacity_, kSlotEmpty);
    for (uint32_t slot = 0; slot < capacity_; ++slot) {
      if (keys_[slot] == kNoTriangle) continue;
      const uint32_t moved = claimSlot(larger.ref(), keys_[slot]);
      if (moved == kSlotEmpty) return grow(factor * 2);
      larger.winner_[moved] = winner_[slot];
    }
    capacity_ = larger.capacity_;
    keys_ = std::move(larger.keys_);
    winner_ = std::move(larger.winner_);
  }

  /// Empties the set; keeps its capacity.
  void clear() {
    std::fill(keys_.begin(), keys_.end(), kNoTriangle);
    std::fill(winner_.begin(), winner_.end(), kSlotEmpty);
    std::fill(fresh_.begin(), fresh_.end(), 0u);
    overflow_ = 0;
  }

  uint64_t bytes() const { return (keys_.size() + winner_.size() + fresh_.size()) * sizeof(uint32_t); }

 private:
  uint32_t capacity_;
  std::vector<uint32_t> keys_, winner_, fresh_;
  uint32_t overflow_ = 0;
};

}  // namespace sightline
