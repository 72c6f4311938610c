#pragma once
#include <cstdint>

#include "core/opencl/opencl_context.h"

namespace sightline {

/// The set of found triangles in an OpenCL device's memory (core/shared/set.h), array or hash set. Kernels
/// with SL_SET_ARGS take keys(), winner(), fresh(), overflow() and capacity().
class OpenClSet {
 public:
  /// overflow: a buffer whose first word is raised where a launch found no room.
  OpenClSet(OpenClContext& context, const ClBuffer& overflow, uint32_t triangle_count, bool hash);

  const ClBuffer& keys() const { return keys_; }
  const ClBuffer& winner() const { return winner_; }
  const ClBuffer& fresh() const { return fresh_; }
  const ClBuffer& overflow() const { return overflow_; }
  uint32_t capacity() const { return capacity_; }  ///< 0: array
  uint32_t freshWords() const { return fresh_words_; }

  /// Empties the set; keeps its capacity.
  void clear();
  /// Makes a hash set `factor` times as large, or more, keeping its contents; an array stays as it is
  /// (HostSet::grow). Throws Error.
  void grow(uint32_t factor);
  /// Doubles the hash set until `size` triangles fill at most half of it.
  void fit(uint32_t size);

 private:
  void allocate(uint32_t capacity);
  /// Whether a launch found no room; lowers the flag.
  bool takeOverflow();

  OpenClContext& context_;
  ClKernel rehash_;
  uint32_t fresh_words_;
  uint32_t capacity_ = 0;
  uint32_t slots_;
  const ClBuffer& overflow_;
  ClBuffer keys_, winner_, fresh_;
};

}  // namespace sightline
