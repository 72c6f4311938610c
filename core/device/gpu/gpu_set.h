#pragma once
#include <cstdint>
#include <utility>

#include "core/device/gpu/gpu_stage.h"
#include "core/device/hash_capacity.h"
#include "core/shared/counters.h"
#include "core/shared/set.h"

namespace sightline {

/// The set of found triangles in a GPU's memory (core/shared/set.h), array or hash set, bound for all stages.
/// Api: as of GpuSampler.
template <typename Api>
class GpuSet {
 public:
  using Buffer = typename Api::Buffer;

  GpuSet(Api& api, uint32_t triangle_count, bool hash)
      : api_(api),
        fresh_words_((triangle_count + 31) / 32),
        slots_(triangle_count),
        fresh_(api.buffer(uint64_t(fresh_words_) * 4, "bits of new triangles")) {
    api_.bind(StageBuffer::fresh, fresh_);
    if (hash) {
      allocate(kFirstHashCapacity);
    } else {
      winner_ = api_.buffer(uint64_t(slots_) * 4, "set");
      api_.bind(StageBuffer::winner, winner_);
    }
    api_.launch().capacity = capacity_;
    clear();
  }

  uint32_t capacity() const { return capacity_; }  ///< 0: array
  const Buffer& keys() const { return keys_; }
  const Buffer& winner() const { return winner_; }
  const Buffer& fresh() const { return fresh_; }
  uint32_t freshWords() const { return fresh_words_; }

  /// Empties the set; keeps its capacity.
  void clear() {
    empty();
    api_.fill(fresh_, 0, uint64_t(fresh_words_) * 4);
  }

  /// Makes a hash set `factor` times as large, or more, keeping its contents; an array stays as it is
  /// (HostSet::grow). The counters must have been taken. Throws Error.
  void grow(uint32_t factor) {
    if (capacity_ == 0) return;
    const uint32_t old_capacity = capacity_;
    uint32_t capacity = grownCapacity(old_capacity, factor);
    Buffer old_keys = std::move(keys_), old_winner = std::move(winner_);
    api_.bind(StageBuffer::old_keys, old_keys);
    api_.bind(StageBuffer::old_winner, old_winner);
    for (;; capacity = grownCapacity(capacity, 2)) {
      allocate(capacity);
      empty();
      api_.run(GpuStage::kRehash, old_capacity);
      if (api_.takeCounters()[kOverflowCounter] == 0) break;
    }
    api_.release(old_keys);
    api_.release(old_winner);
  }

  /// Doubles the hash set until `size` triangles fill at most half of it. As grow.
  void fit(uint32_t size) {
    while (capacity_ > 0 && uint64_t(size) * 2 > capacity_) grow(2);
  }

 private:
  void allocate(uint32_t capacity) {
    api_.release(keys_);
    api_.release(winner_);
    keys_ = api_.buffer(uint64_t(capacity) * 4, "keys of the hash set");
    winner_ = api_.buffer(uint64_t(capacity) * 4, "hash set");
    api_.bind(StageBuffer::keys, keys_);
    api_.bind(StageBuffer::winner, winner_);
    api_.launch().capacity = capacity_ = slots_ = capacity;
  }

  void empty() {
    if (capacity_ > 0) api_.fill(keys_, kNoTriangle, uint64_t(slots_) * 4);
    api_.fill(winner_, kSlotEmpty, uint64_t(slots_) * 4);
  }

  Api& api_;
  uint32_t fresh_words_;
  uint32_t capacity_ = 0;
  uint32_t slots_;
  Buffer keys_, winner_, fresh_;
};

}  // namespace sightline
