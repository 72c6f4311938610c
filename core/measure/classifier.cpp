#include "core/measure/classifier.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/error.h"

namespace sightline {

Classifier::Classifier(std::span<const RankedSet> sets, uint32_t views, uint32_t resolution)
    : resolution_(resolution), scratch_([resolution] { return Scratch(resolution); }) {
  suspect_.assign(sets.front().rank.size(), 0);
  for (const RankedSet& set : sets) {
    if (set.rank.size() != suspect_.size()) throw Error("measure: the sets are of different scenes");
    const auto& sizes = set.prefixes;
    const size_t empty = size_t(std::upper_bound(sizes.begin(), sizes.end(), 0u) - sizes.begin());
    sets_.push_back({missingLevels(set), empty, sizes.size(), std::vector<ImageError>(sizes.size() * views)});
    any_empty_ = any_empty_ || empty > 0;
    std::vector<uint16_t>& levels = sets_.back().levels;
    tbb::parallel_for(size_t(0), levels.size(), [&](size_t i) {
      levels[i] = uint16_t(levels[i] - empty);  // every triangle is missed by all of these
      if (levels[i] > 0) suspect_[i] = 1;
    });
  }
}

void Classifier::classify(uint32_t first, std::span<const uint32_t> images) {
  classifyViews(first, images, sets_);
}

void Classifier::classify(uint32_t first, std::span<const uint32_t> images, size_t set) {
  classifyViews(first, images, std::span(sets_).subspan(set, 1));
}

void Classifier::classifyViews(uint32_t first, std::span<const uint32_t> images, std::span<Set> sets) {
  const size_t pixels = size_t(resolution_) * resolution_;
  tbb::parallel_for(size_t(0), images.size() / pixels, [&](size_t i) {
    classifyView(first + uint32_t(i), images.subspan(i * pixels, pixels), sets);
  });
}

std::span<const ImageError> Classifier::errors(size_t set, uint32_t view) const {
  const size_t prefixes = sets_[set].prefixes;
  return std::span(sets_[set].errors).subspan(view * prefixes, prefixes);
}

/// Adds to the last run if it goes on in the same row.
void Classifier::addRun(std::vector<PixelRun>& runs, const PixelRun& run) const {
  const bool goes_on = !runs.empty() && runs.back().last + 1 == run.first && runs.back().level == run.level &&
                       run.first % resolution_ != 0;
  if (goes_on) {
    runs.back().last = run.last;
  } else {
    runs.push_back(run);
  }
}

/// Fills scratch.suspects, and scratch.runs with all that shows a triangle, if some set has a prefix of
/// nothing.
void Classifier::splitImage(std::span<const uint32_t> image, Scratch& scratch) const {
  scratch.suspects.clear();
  scratch.runs.clear();
  for (uint32_t first = 0, next = 0; first < image.size(); first = next) {
    const uint32_t triangle = image[first], row_end = first - first % resolution_ + resolution_;
    for (next = first + 1; next < row_end && image[next] == triangle;) ++next;
    if (triangle == kNoTriangle) continue;
    if (any_empty_) addRun(scratch.runs, {first, next - 1, 1});
    if (suspect_[triangle] != 0) scratch.suspects.push_back({first, next - 1, triangle});
  }
}

void Classifier::classifyView(uint32_t view, std::span<const uint32_t> image, std::span<Set> sets) {
  Scratch& scratch = scratch_.local();
  splitImage(image, scratch);
  ImageError nothing;  // of a set of nothing: the same for all sets
  if (!scratch.runs.empty()) scratch.regions.count(scratch.runs, std::span(&nothing, 1));
  for (Set& set : sets) {
    const auto errors = std::span(set.errors).subspan(view * set.prefixes, set.prefixes);  // zeros
    std::fill_n(errors.begin(), set.empty, nothing);
    scratch.runs.clear();
    for (const Stretch& stretch : scratch.suspects) {
      const uint16_t level = set.levels[stretch.triangle];
      if (level > 0) addRun(scratch.runs, {stretch.first, stretch.last, level});
    }
    if (!scratch.runs.empty()) scratch.regions.count(scratch.runs, errors.subspan(set.empty));
  }
}

}  // namespace sightline
