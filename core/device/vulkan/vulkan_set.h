#pragma once
#include "core/device/vulkan/vulkan_runner.h"

namespace sightline {

/// The set of found triangles in a Vulkan device's memory (core/shared/set.h), array or hash set. Keeps the
/// runner's launch up to date.
class VulkanSet {
 public:
  VulkanSet(const VulkanContext& context, VulkanRunner& runner, uint32_t triangle_count, bool hash);

  uint32_t capacity() const { return capacity_; }  ///< 0: array
  const VulkanBuffer& fresh() const { return fresh_; }
  uint32_t freshWords() const { return fresh_words_; }

  /// Empties the set; keeps its capacity.
  void clear();
  /// Makes a hash set `factor` times as large, or more, keeping its contents; an array stays as it is
  /// (HostSet::grow). The counts must have been taken. Throws Error.
  void grow(uint32_t factor);
  /// Doubles the hash set until `size` triangles fill at most half of it. As grow.
  void fit(uint32_t size);

 private:
  void allocate(uint32_t capacity);
  void empty();

  const VulkanContext& context_;
  VulkanRunner& runner_;
  VulkanStage rehash_;
  uint32_t fresh_words_;
  uint32_t capacity_ = 0;
  uint32_t slots_;
  VulkanBuffer keys_, winner_, fresh_;
};

}  // namespace sightline
