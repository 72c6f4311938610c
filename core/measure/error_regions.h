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

/// Pixels of one row side by side: of the same triangle, mostly. Numbered row by row.
struct PixelRun {
  uint32_t first, last;
  uint16_t level;  ///< wrong for the first so many sets of a series
};

/// Counts wrong pixels and their regions in images, for a whole series of ever larger sets at once.
/// Reused from image to image; not thread-safe.
class ErrorRegions {
 public:
  /// Pixels a side, 1 .. 16,384.
  ErrorRegions(uint32_t width, uint32_t height);
  explicit ErrorRegions(uint32_t resolution) : ErrorRegions(resolution, resolution) {}

  /// runs: ascending, without a pixel in common, levels 1 .. errors.size(). errors[k] becomes that of the
  /// runs with a level above k.
  void count(std::span<const PixelRun> runs, std::span<ImageError> errors);

 private:
  struct Run {
    PixelRun pixels;
    uint32_t parent;  ///< another run of its region, itself at the root; kFree: not wrong yet
    uint32_t size;    ///< at a root: pixels of the region
  };

  void markRuns(std::span<const PixelRun> runs);
  void sortRuns(size_t level_count);
  uint32_t root(uint32_t run);
  uint32_t add(uint32_t run, ImageError& error);
  uint32_t joinRow(uint32_t region, uint32_t first, uint32_t last, ImageError& error);

  uint32_t width_, height_;
  std::vector<uint32_t> run_of_;  ///< a pixel; kFree: right
  std::vector<Run> runs_;
  std::vector<uint32_t> starts_, order_;
};

}  // namespace sightline
