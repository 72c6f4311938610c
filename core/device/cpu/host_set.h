#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/device/hash_capacity.h"
#include "core/shared/set.h"

namespace sightline {

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

  /// Makes a hash set `factor` (2, 4, 8 ...) times as large, or more, keeping its contents. An array stays as
  /// it is: it has a slot for every triangle, and overflows only where a thread lost every race for one, so
  /// that its launch need but be repeated. Throws Error, and the set stays as it is.
  void grow(uint32_t factor) {
    if (!isHash()) return;
    uint32_t capacity = grownCapacity(capacity_, factor);
    while (!moveTo(capacity)) capacity = grownCapacity(capacity, 2);
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
  /// Moves the contents into a table of this capacity. false: one found no slot, and nothing was changed.
  bool moveTo(uint32_t capacity) {
    std::vector<uint32_t> keys(capacity, kNoTriangle), winner(capacity, kSlotEmpty);
    const SetRef larger{keys.data(), winner.data(), fresh_.data(), &overflow_, capacity};
    for (uint32_t slot = 0; slot < capacity_; ++slot) {
      if (keys_[slot] == kNoTriangle) continue;
      const uint32_t moved = claimSlot(larger, keys_[slot]);
      if (moved == kSlotEmpty) return false;
      winner[moved] = winner_[slot];
    }
    capacity_ = capacity;
    keys_ = std::move(keys);
    winner_ = std::move(winner);
    return true;
  }

  uint32_t capacity_;
  std::vector<uint32_t> keys_, winner_, fresh_;
  uint32_t overflow_ = 0;
};

}  // namespace sightline
