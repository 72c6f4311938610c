// Based on: R. Tarjan and J. van Leeuwen, "Worst-case analysis of set union algorithms", 1984 (union by size,
// path halving), over runs of pixels. Sets shrink from the last of the series to the first, so regions only
// ever grow and merge.
#include "core/measure/error_regions.h"

#include <algorithm>
#include <utility>

namespace sightline {
namespace {

constexpr uint32_t kFree = 0xffffffffu;

}  // namespace

ErrorRegions::ErrorRegions(uint32_t width, uint32_t height)
    : width_(width), height_(height), run_of_(size_t(width) * height, kFree) {}

void ErrorRegions::markRuns(std::span<const PixelRun> runs) {
  runs_.clear();
  for (const PixelRun& run : runs) {
    std::fill(run_of_.begin() + run.first, run_of_.begin() + run.last + 1, uint32_t(runs_.size()));
    runs_.push_back({run, kFree, 0});
  }
}

/// Counting sort by level; starts_[level] becomes where the next level starts.
void ErrorRegions::sortRuns(size_t level_count) {
  starts_.assign(level_count + 2, 0);
  for (const Run& run : runs_) ++starts_[run.pixels.level + 1];
  for (size_t level = 1; level < starts_.size(); ++level) starts_[level] += starts_[level - 1];
  order_.resize(runs_.size());
  for (uint32_t i = 0; i < runs_.size(); ++i) order_[starts_[runs_[i].pixels.level]++] = i;
}

uint32_t ErrorRegions::root(uint32_t run) {
  while (runs_[run].parent != run) run = runs_[run].parent = runs_[runs_[run].parent].parent;
  return run;
}

/// Joins the region (a root) with those of all wrong pixels from `first` to `last`, of one row. Returns the
/// root.
uint32_t ErrorRegions::joinRow(uint32_t region, uint32_t first, uint32_t last, ImageError& error) {
  for (uint32_t pixel = first; pixel <= last; ++pixel) {
    const uint32_t run = run_of_[pixel];
    if (run == kFree) continue;
    pixel = runs_[run].pixels.last;  // the rest of it is of the same region
    if (runs_[run].parent == kFree) continue;
    uint32_t other = root(run);
    if (other == region) continue;
    if (runs_[region].size < runs_[other].size) std::swap(region, other);
    runs_[other].parent = region;
    runs_[region].size += runs_[other].size;
    --error.regions;
  }
  return region;
}

/// Makes the pixels of a run wrong. Returns the size of their region.
uint32_t ErrorRegions::add(uint32_t run, ImageError& error) {
  const PixelRun mine = runs_[run].pixels;
  const uint32_t size = mine.last - mine.first + 1;
  runs_[run].parent = run;
  runs_[run].size = size;
  error.wrong += size;
  ++error.regions;
  const uint32_t row = mine.first / width_, start = row * width_, end = start + width_ - 1;
  const uint32_t first = std::max(mine.first, start + 1) - 1, last = std::min(mine.last + 1, end);
  uint32_t region = joinRow(run, first, last, error);
  if (row > 0) region = joinRow(region, first - width_, last - width_, error);
  if (row + 1 < height_) region = joinRow(region, first + width_, last + width_, error);
  return runs_[region].size;
}

void ErrorRegions::count(std::span<const PixelRun> runs, std::span<ImageError> errors) {
  markRuns(runs);
  sortRuns(errors.size());
  ImageError error;
  for (size_t level = errors.size(); level > 0; --level) {
    for (uint32_t i = starts_[level - 1]; i < starts_[level]; ++i) {
      error.largest_region = std::max(error.largest_region, add(order_[i], error));
    }
    errors[level - 1] = error;
  }
  for (const PixelRun& run : runs) {
    std::fill(run_of_.begin() + run.first, run_of_.begin() + run.last + 1, kFree);
  }
}

}  // namespace sightline
