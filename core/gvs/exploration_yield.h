#pragma once
#include <algorithm>
#include <cstdint>

namespace sightline {

/// What border and reverse rays promise, in new triangles a ray, by what the last batch of each found. Counts
/// rays, not time, so that every device decides alike.
class ExplorationYield {
 public:
  /// batch_rays: of a full batch.
  explicit ExplorationYield(uint32_t batch_rays) : batch_rays_(batch_rays) {}

  /// Books a batch of border rays.
  void bookBorder(uint32_t entries, uint64_t rays, uint32_t found) {
    border_rays_each_ = std::max(1.0, double(rays) / entries);
    border_found_each_ = double(found) / entries;
  }

  /// Books a batch of reverse rays. Counts half what they find: it is small, or seen from few places.
  void bookReverse(uint64_t rays, uint32_t found) { reverse_ = 0.5 * found / (double(rays) + launch()); }

  /// Of the next batch of border rays, where `entries` wait for theirs.
  double border(uint32_t entries) const {
    const double rays = std::min(entries * border_rays_each_, batch_rays_);
    return rays / border_rays_each_ * border_found_each_ / (rays + launch());
  }

  double reverse() const { return reverse_; }

 private:
  /// What a batch costs besides its rays, in rays: a GPU takes as long for an eighth of a full one.
  double launch() const { return batch_rays_ / 8; }

  double batch_rays_;
  double border_rays_each_ = 50, border_found_each_ = 1;  ///< of an entry
  double reverse_ = 1e-3;
};

}  // namespace sightline
