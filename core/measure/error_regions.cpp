// Based on: R. Tarjan and J. van Leeuwen, "Worst-case analysis of set union algorithms", 1984 (union by size,
// path halving). Sets shrink from the last of the series to the first, so regions only ever grow and merge.
#include "core/measure/error_regions.h"

#include <algorithm>
#include <utility>

namespace sightline {
namespace {

constexpr uint32_t kFree = 0xffffffffu;

}  // namespace

ErrorRegions::ErrorRegions(uint32_t resolution)
    : resolution_(resolution), parent_(size_t(resolution) * resolution, kFree), size_(parent_.size()) {}

uint32_t ErrorRegions::root(uint32_t pixel) {
  while (parent_[pixel] != pixel) pixel = parent_[pixel] = parent_[parent_[pixel]];
  return pixel;
}

/// Makes a pixel wrong. Returns the size of its region.
uint32_t ErrorRegions::add(uint32_t pixel, ImageError& error) {
  parent_[pixel] = pixel;
  size_[pixel] = 1;
  ++error.wrong;
  ++error.regions;
  const uint32_t x = pixel % resolution_, y = pixel / resolution_;
  const uint32_t left = x > 0 ? x - 1 : x, right = std::min(x + 1, resolution_ - 1);
  const uint32_t top = y > 0 ? y - 1 : y, bottom = std::min(y + 1, resolution_ - 1);
  uint32_t mine = pixel;
  for (uint32_t row = top; row <= bottom; ++row) {
    for (uint32_t column = left; column <= right; ++column) {
      const uint32_t neighbour = row * resolution_ + column;
      if (parent_[neighbour] == kFree) continue;
      uint32_t other = root(neighbour);
      if (other == mine) continue;
      if (size_[mine] < size_[other]) std::swap(mine, other);
      parent_[other] = mine;
      size_[mine] += size_[other];
      --error.regions;
    }
  }
  return size_[mine];
}

void ErrorRegions::count(std::span<const uint32_t> pixels, std::span<const uint16_t> levels,
                         std::span<ImageError> errors) {
  // Counting sort by level.
  starts_.assign(errors.size() + 2, 0);
  for (const uint16_t level : levels) ++starts_[level + 1];
  for (size_t level = 1; level < starts_.size(); ++level) starts_[level] += starts_[level - 1];
  order_.resize(pixels.size());
  for (size_t i = 0; i < pixels.size(); ++i) order_[starts_[levels[i]]++] = pixels[i];
  // Now starts_[level] is where the next level starts.
  ImageError error;
  for (size_t level = errors.size(); level > 0; --level) {
    for (uint32_t i = starts_[level - 1]; i < starts_[level]; ++i) {
      error.largest_region = std::max(error.largest_region, add(order_[i], error));
    }
    errors[level - 1] = error;
  }
  for (const uint32_t pixel : pixels) parent_[pixel] = kFree;
}

}  // namespace sightline
