#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace sightline {

/// The wrong pixels of one image.
struct ImageError {
  uint32_t wrong = 0;
  uint32_t regions = 0;         ///< groups of wrong pixels that touch, at corners too (8-neighbourhood)
  uint32_t largest_region = 0;  ///< pixels
  bool operator==(const ImageError&) const = default;
};

/// Counts wrong pixels and their regions in square images, for a whole series of ever larger sets at once: a
/// pixel of level n is wrong for the first n of them. Reused from image to image; not thread-safe.
class ErrorRegions {
 public:
  /// resolution: pixels a side, 1 .. kMaxViewResolution.
  explicit ErrorRegions(uint32_t resolution);

  /// pixels: their numbers, row by row, no one twice; levels: of each, 1 .. errors.size(). errors[k] becomes
  /// that of the pixels with a level above k.
  void count(std::span<const uint32_t> pixels, std::span<const uint16_t> levels,
             std::span<ImageError> errors);

 private:
  uint32_t root(uint32_t pixel);
  uint32_t add(uint32_t pixel, ImageError& error);

  uint32_t resolution_;
  std::vector<uint32_t> parent_;  ///< a pixel: another of its region, itself at the root; kFree: not wrong
  std::vector<uint32_t> size_;    ///< at a root: pixels of the region
  std::vector<uint32_t> starts_, order_;
};

}  // namespace sightline
