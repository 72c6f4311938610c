#include "core/measure/classifier.h"

#include <tbb/parallel_for.h>

#include "core/error.h"

namespace sightline {

Classifier::Classifier(std::span<const RankedSet> sets, uint32_t views, uint32_t resolution)
    : resolution_(resolution), scratch_([resolution] { return Scratch(resolution); }) {
  suspect_.assign(sets.front().rank.size(), 0);
  for (const RankedSet& set : sets) {
    if (set.rank.size() != suspect_.size()) throw Error("measure: the sets are of different scenes");
    const size_t prefixes = set.prefixes.size();
    sets_.push_back({missingLevels(set), prefixes, std::vector<ImageError>(prefixes * views)});
    const std::vector<uint16_t>& levels = sets_.back().levels;
    tbb::parallel_for(size_t(0), levels.size(), [&](size_t i) {
      if (levels[i] > 0) suspect_[i] = 1;
    });
  }
}

void Classifier::classify(uint32_t first, std::span<const uint32_t> images) {
  const size_t pixels = size_t(resolution_) * resolution_;
  tbb::parallel_for(size_t(0), images.size() / pixels,
                    [&](size_t i) { classifyView(first + uint32_t(i), images.subspan(i * pixels, pixels)); });
}

std::span<const ImageError> Classifier::errors(size_t set, uint32_t view) const {
  const size_t prefixes = sets_[set].prefixes;
  return std::span(sets_[set].errors).subspan(view * prefixes, prefixes);
}

void Classifier::classifyView(uint32_t view, std::span<const uint32_t> image) {
  Scratch& scratch = scratch_.local();
  scratch.suspects.clear();
  for (uint32_t pixel = 0; pixel < image.size(); ++pixel) {
    const uint32_t triangle = image[pixel];
    if (triangle != kNoTriangle && suspect_[triangle] != 0) scratch.suspects.push_back(pixel);
  }
  if (scratch.suspects.empty()) return;  // all errors start with zeros
  for (Set& set : sets_) {
    scratch.pixels.clear();
    scratch.levels.clear();
    for (const uint32_t pixel : scratch.suspects) {
      const uint16_t level = set.levels[image[pixel]];
      if (level == 0) continue;
      scratch.pixels.push_back(pixel);
      scratch.levels.push_back(level);
    }
    if (scratch.pixels.empty()) continue;
    scratch.regions.count(scratch.pixels, scratch.levels,
                          std::span(set.errors).subspan(view * set.prefixes, set.prefixes));
  }
}

}  // namespace sightline
