#include "core/device/naive/naive_device.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <unordered_map>

#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/shared/set.h"

namespace sightline {
namespace {

/// Rays that travel together.
constexpr size_t kChunk = 1u << 20;

class NaiveDevice final : public Device {
  // Generators first: their types are deduced.
  auto slotRays(const RandomSegment& segment, uvec4 shifts) const {
    return SlotRays(segment, faces_.at(segment.range.x), shifts);
  }

  auto reverseRays(uint32_t first) const {
    return ReverseRays({&scene_, faces_, &params_, entries_, std::span(discontinuities_).subspan(first),
                        items_before_ + first});
  }

 public:
  NaiveDevice(std::unique_ptr<Device> inner, const Scene& scene) : inner_(std::move(inner)), scene_(scene) {}

  DeviceInfo info() const override {
    DeviceInfo info = inner_->info();
    info.naive = true;
    return info;
  }

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    faces_.assign(faces.begin(), faces.end());
    params_ = params;
    set_.clear();
    entries_.clear();
    discontinuities_.clear();
    collected_ = 0;
    rays_traced_ = items_before_ = 0;
  }

  void traceRandom(const RandomSegment& segment) override {
    trace(
        slotCount(segment), [&] { return slotRays(segment, params_.shifts); },
        [&](const BatchRay& ray, const Hit&, std::span<const uint32_t> seen) { insert(seen, ray); });
  }

  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    const std::vector<PvsEntry> pending = entriesFrom(first, mostBorderEntries(most_rays, params_));
    std::vector<uint64_t> starts = borderStarts(scene_, pending, params_);
    const uint32_t count = borderBatchEntries(starts, most_rays);
    starts.resize(count + 1);
    const BorderRays batch(scene_, pending, starts, params_);
    std::vector<uint32_t> border_hits(starts.back(), isGvs(params_) ? kNotTraced : kNoTriangle);
    std::vector<uint8_t> is_discontinuity(starts.back(), 0);
    const auto take = [&](const BatchRay& ray, const Hit& hit, std::span<const uint32_t> seen) {
      insert(seen, ray);
      const uint32_t index = ray.index - 1;
      border_hits[index] = hit.triangle;
      if (!listing) return;
      const PvsEntry& entry = pending[batch.entryOf(index)];
      is_discontinuity[index] = isDiscontinuityOf(scene_, entry, ray.ray, hit, params_) ? 1 : 0;
    };
    for (uint32_t level = 0; isGvs(params_) && level < kGvsLevels; ++level) {
      trace(
          uint64_t(count) * gvsSlots(level), [&] { return GvsLevelRays(level, batch, border_hits); }, take);
    }
    if (!isGvs(params_)) {
      trace(
          starts.back(),
          [&] {
            return [rays = batch](uint32_t number) mutable { return BatchRay{rays(number), number + 1}; };
          },
          take);
    }
    const size_t before = discontinuities_.size();
    if (listing) {
      appendDiscontinuitiesOf(scene_, pending, first, starts, border_hits, is_discontinuity, params_,
                              discontinuities_);
    }
    return {count, static_cast<uint32_t>(discontinuities_.size() - before)};
  }

  void traceReverse(uint32_t first, uint32_t count) override {
    trace(
        uint64_t(count) * reverseRayCount(params_), [&] { return reverseRays(first); },
        [&](const BatchRay& ray, const Hit&, std::span<const uint32_t> seen) { insert(seen, ray); });
  }

  uint32_t collect(uint32_t stage) override {
    const auto begin = entries_.begin() + collected_;
    std::sort(begin, entries_.end(),
              [](const PvsEntry& a, const PvsEntry& b) { return a.origin_triangle.w < b.origin_triangle.w; });
    for (auto entry = begin; entry != entries_.end(); ++entry) {
      entry->direction_stage.w = stage;
      set_[entry->origin_triangle.w].index = kSlotOld;
    }
    const auto found = static_cast<uint32_t>(entries_.end() - begin);
    collected_ += found;
    return found;
  }

  void insertContained(std::span<const uint32_t> triangles) override {
    insert(triangles, {noRay(), 1});
    collect(kStageContained);
  }

  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    uint64_t missing = 0;
    trace(
        slotCount(segment), [&] { return slotRays(segment, shifts); },
        [&](const BatchRay&, const Hit&, std::span<const uint32_t> seen) {
          missing +=
              std::ranges::any_of(seen, [&](uint32_t triangle) { return !set_.contains(triangle); }) ? 1 : 0;
        });
    return missing;
  }

  void dropDiscontinuities() override {
    items_before_ += discontinuities_.size();
    discontinuities_.clear();
  }

  DeviceCounters counters() override { return {rays_traced_, inner_->counters().memory_bytes, true}; }
  std::vector<PvsEntry> readPvs() override { return entries_; }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override { inner_->traceRays(rays, hits); }
  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    return inner_->traceGlass(rays, hits);
  }
  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    inner_->traceViews(views, resolution, triangles);
  }

 private:
  /// A triangle of the set: the lowest index (1 ..) of the batch's rays that hit it, or kSlotOld; and, in its
  /// batch, its place in entries_.
  struct Found {
    uint32_t index = kSlotOld;
    size_t place = 0;
  };

  /// Those of the list from `first`, so many at most: a copy, for hits are appended while their rays are
  /// made.
  std::vector<PvsEntry> entriesFrom(uint32_t first, uint32_t most) const {
    const auto begin = entries_.begin() + first;
    return {begin, begin + std::min<ptrdiff_t>(most, entries_.end() - begin)};
  }

  void insert(std::span<const uint32_t> triangles, const BatchRay& ray) {
    for (const uint32_t triangle : triangles) insert(triangle, ray);
  }

  void insert(uint32_t triangle, const BatchRay& ray) {
    const auto [slot, is_new] = set_.try_emplace(triangle, Found{ray.index, entries_.size()});
    if (is_new) {
      entries_.push_back(entryOf(triangle, ray.ray, 0));
    } else if (ray.index < slot->second.index) {
      slot->second.index = ray.index;
      entries_[slot->second.place] = entryOf(triangle, ray.ray, 0);
    }
  }

  /// Traces the rays 0 .. count - 1 of generators that makeGenerator() returns, and hands those that have a
  /// direction to take(ray, hit, seen), in order. seen: the triangles that they see, that of the hit first.
  void trace(uint64_t count, auto&& makeGenerator, auto&& take) {
    for (uint64_t first = 0; first < count; first += kChunk) {
      const auto size = static_cast<size_t>(std::min<uint64_t>(kChunk, count - first));
      batch_.resize(size);
      rays_.resize(size);
      hits_.resize(size);
      tbb::parallel_for(tbb::blocked_range<size_t>(0, size, 512), [&](const auto& range) {
        auto generate = makeGenerator();
        for (size_t i = range.begin(); i < range.end(); ++i) {
          batch_[i] = generate(static_cast<uint32_t>(first + i));
          rays_[i] = batch_[i].ray;
        }
      });
      inner_->traceRays(rays_, hits_);
      const std::vector<SeenThrough> glass = inner_->traceGlass(rays_, hits_);
      auto through = glass.begin();
      std::vector<uint32_t> seen;
      for (size_t i = 0; i < size; ++i) {
        seen.clear();
        if (hits_[i].triangle != kNoTriangle) seen.push_back(hits_[i].triangle);
        for (; through != glass.end() && through->ray == i; ++through) seen.push_back(through->triangle);
        if (!hasDirection(rays_[i])) continue;
        ++rays_traced_;
        take(batch_[i], hits_[i], seen);
      }
    }
  }

  std::unique_ptr<Device> inner_;
  const Scene& scene_;
  std::vector<Face> faces_;
  StageParams params_{};
  std::unordered_map<uint32_t, Found> set_;
  std::vector<PvsEntry> entries_;  ///< the list, and after `collected_` of them those of the open batch
  size_t collected_ = 0;
  std::vector<Discontinuity> discontinuities_;
  uint64_t items_before_ = 0;  ///< discontinuities of the cell that were dropped
  uint64_t rays_traced_ = 0;
  std::vector<BatchRay> batch_;  ///< of a chunk
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
};

}  // namespace

std::unique_ptr<Device> makeNaiveDevice(std::unique_ptr<Device> inner, const Scene& scene) {
  return std::make_unique<NaiveDevice>(std::move(inner), scene);
}

}  // namespace sightline
