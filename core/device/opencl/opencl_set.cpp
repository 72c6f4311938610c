#include "core/device/opencl/opencl_set.h"

#include "core/device/hash_capacity.h"
#include "core/shared/set.h"

namespace sightline {
OpenClSet::OpenClSet(OpenClContext& context, const ClBuffer& overflow, uint32_t triangle_count, bool hash)
    : context_(context),
      rehash_(context.kernel("rehash")),
      fresh_words_((triangle_count + 31) / 32),
      slots_(triangle_count),
      overflow_(overflow),
      fresh_(context.buffer(uint64_t(fresh_words_) * 4, "bits of new triangles")) {
  if (hash) {
    allocate(kFirstHashCapacity);
  } else {
    keys_ = context.buffer(0, "keys of the set");
    winner_ = context.buffer(uint64_t(slots_) * 4, "set");
  }
  clear();
}

void OpenClSet::allocate(uint32_t capacity) {
  capacity_ = slots_ = capacity;
  keys_ = context_.buffer(uint64_t(capacity) * 4, "keys of the hash set");
  winner_ = context_.buffer(uint64_t(capacity) * 4, "hash set");
}

void OpenClSet::clear() {
  if (capacity_ > 0) context_.fill(keys_, kNoTriangle, uint64_t(slots_) * 4);
  context_.fill(winner_, kSlotEmpty, uint64_t(slots_) * 4);
  context_.fill(fresh_, 0, uint64_t(fresh_words_) * 4);
}

bool OpenClSet::takeOverflow() {
  uint32_t count = 0;
  context_.read(overflow_, &count, 4);
  if (count != 0) context_.fill(overflow_, 0, 4);
  return count != 0;
}

void OpenClSet::grow(uint32_t factor) {
  if (capacity_ == 0) return;
  const uint32_t old_capacity = capacity_;
  uint32_t capacity = grownCapacity(old_capacity, factor);
  const ClBuffer old_keys = std::move(keys_), old_winner = std::move(winner_);
  for (;; capacity = grownCapacity(capacity, 2)) {
    allocate(capacity);
    context_.fill(keys_, kNoTriangle, uint64_t(capacity) * 4);
    context_.fill(winner_, kSlotEmpty, uint64_t(capacity) * 4);
    context_.launch(rehash_, old_capacity, 64, old_keys, old_winner, old_capacity, keys_, winner_, fresh_,
                    overflow_, capacity_);
    if (!takeOverflow()) return;
  }
}

void OpenClSet::fit(uint32_t size) {
  while (capacity_ > 0 && uint64_t(size) * 2 > capacity_) grow(2);
}

}  // namespace sightline
