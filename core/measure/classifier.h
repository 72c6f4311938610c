#pragma once
#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/measure/error_regions.h"
#include "core/measure/ranked_set.h"

namespace sightline {

/// Sorts the pixels of id images into right and wrong ones, for all prefixes of several sets.
class Classifier {
 public:
  /// The sets of one scene, at least one. Throws Error.
  Classifier(std::span<const RankedSet> sets, uint32_t views, uint32_t resolution);

  /// Images (Tracer::traceViews) of the views from `first` on, as many as `images` holds.
  void classify(uint32_t first, std::span<const uint32_t> images);

  /// The same for one of the sets alone: where a pixel shows several triangles, sets differ in which matters.
  void classify(uint32_t first, std::span<const uint32_t> images, size_t set);

  /// Error of one view, of each prefix of a set.
  std::span<const ImageError> errors(size_t set, uint32_t view) const;

 private:
  /// Pixels of one row side by side that show the same triangle.
  struct Stretch {
    uint32_t first, last, triangle;
  };
  struct Scratch {
    explicit Scratch(uint32_t resolution) : regions(resolution) {}
    ErrorRegions regions;
    std::vector<Stretch> suspects;
    std::vector<PixelRun> runs;
  };
  struct Set {
    std::vector<uint16_t> levels;    ///< missingLevels, those of prefix 0 not counted
    size_t empty = 0;                ///< prefixes that are 0: of nothing
    size_t prefixes = 0;             ///< all, those of nothing first
    std::vector<ImageError> errors;  ///< view by view, of each all prefixes
  };

  void classifyViews(uint32_t first, std::span<const uint32_t> images, std::span<Set> sets);
  void classifyView(uint32_t view, std::span<const uint32_t> image, std::span<Set> sets);
  void splitImage(std::span<const uint32_t> image, Scratch& scratch) const;
  void addRun(std::vector<PixelRun>& runs, const PixelRun& run) const;

  uint32_t resolution_;
  std::vector<uint8_t> suspect_;  ///< a triangle: missed by some prefix of some set that is not of nothing
  bool any_empty_ = false;        ///< some set has a prefix of nothing
  std::vector<Set> sets_;
  tbb::enumerable_thread_specific<Scratch> scratch_;
};

}  // namespace sightline
