#include "core/device/vulkan/vulkan_set.h"

#include "core/device/hash_capacity.h"
#include "core/shared/set.h"

namespace sightline {
VulkanSet::VulkanSet(const VulkanContext& context, VulkanRunner& runner, uint32_t triangle_count, bool hash)
    : context_(context),
      runner_(runner),
      fresh_words_((triangle_count + 31) / 32),
      slots_(triangle_count),
      fresh_(context.buffer(uint64_t(fresh_words_) * 4, "bits of new triangles")) {
  runner_.launch.fresh = fresh_.address();
  if (hash) {
    rehash_ = VulkanStage::list(context, "rehash");
    allocate(kFirstHashCapacity);
  } else {
    winner_ = context.buffer(uint64_t(slots_) * 4, "set");
    runner_.launch.winner = winner_.address();
  }
  clear();
}

void VulkanSet::allocate(uint32_t capacity) {
  capacity_ = slots_ = capacity;
  keys_ = context_.buffer(uint64_t(capacity) * 4, "keys of the hash set");
  winner_ = context_.buffer(uint64_t(capacity) * 4, "hash set");
  runner_.launch.keys = keys_.address();
  runner_.launch.winner = winner_.address();
  runner_.launch.capacity = capacity;
}

void VulkanSet::empty() {
  if (capacity_ > 0) runner_.commands.fill(keys_, kNoTriangle, uint64_t(slots_) * 4);
  runner_.commands.fill(winner_, kSlotEmpty, uint64_t(slots_) * 4);
}

void VulkanSet::clear() {
  empty();
  runner_.commands.fill(fresh_, 0, uint64_t(fresh_words_) * 4);
}

void VulkanSet::grow(uint32_t factor) {
  if (capacity_ == 0) return;
  const uint32_t old_capacity = capacity_;
  uint32_t capacity = grownCapacity(old_capacity, factor);
  runner_.commands.finish();
  const VulkanBuffer old_keys = std::move(keys_), old_winner = std::move(winner_);
  runner_.launch.old_keys = old_keys.address();
  runner_.launch.old_winner = old_winner.address();
  for (;; capacity = grownCapacity(capacity, 2)) {
    allocate(capacity);
    empty();
    runner_.run(rehash_, old_capacity);
    if (!runner_.takeCounts().overflow) return;
  }
}

void VulkanSet::fit(uint32_t size) {
  while (capacity_ > 0 && uint64_t(size) * 2 > capacity_) grow(2);
}

}  // namespace sightline
