#include "core/device/naive/naive_device.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <unordered_map>

#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/shared/set.h"
#include "core/trace/narrow_gap.h"

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
  NaiveDevice(std::unique_ptr<Device> inner, const Scene& scene, float smallest_hole)
      : inner_(std::move(inner)), scene_(scene), smallest_hole_(smallest_hole) {}

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
        },
        EachCandidate::kTested);
    return missing;
  }

  void dropDiscontinuities() override {
    items_before_ += discontinuities_.size();
    discontinuities_.clear();
  }

  DeviceCounters counters() override { return {rays_traced_, inner_->counters().memory_bytes, true}; }
  std::vector<PvsEntry> readPvs() override { return entries_; }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override { inner_->traceRays(rays, hits); }
  bool hasGlass() const override { return inner_->hasGlass(); }
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

  /// A triangle that a ray of the chunk sees.
  struct Sighting {
    uint32_t ray;
    Hit hit;
    bool ends_ray;  ///< else it is glass
    bool counts = true;
  };

  /// Whether all that would change the set is tested for gaps, or of each triangle no more than it takes to
  /// find the first ray that has room.
  enum class EachCandidate { kTested, kUntilOneCounts };

  /// Traces the rays 0 .. count - 1 of generators that makeGenerator() returns, and hands those that have a
  /// direction to take(ray, hit, seen), in order. seen: the triangles that they see, that of the hit first.
  /// Where a gap pinches the ray, its hit is what stands nearer beside it, and not seen.
  void trace(uint64_t count, auto&& makeGenerator, auto&& take,
             EachCandidate candidates = EachCandidate::kUntilOneCounts) {
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
      listSightings();
      if (smallest_hole_ > 0) dropPinched(candidates);
      auto sighting = sightings_.begin();
      std::vector<uint32_t> seen;
      for (size_t i = 0; i < size; ++i) {
        seen.clear();
        for (; sighting != sightings_.end() && sighting->ray == i; ++sighting) {
          if (sighting->counts) seen.push_back(sighting->hit.triangle);
        }
        if (!hasDirection(rays_[i])) continue;
        ++rays_traced_;
        take(batch_[i], hits_[i], seen);
      }
    }
  }

  /// What the rays of the chunk see: ray by ray, what ends it first.
  void listSightings() {
    const std::vector<SeenThrough> glass = inner_->traceGlass(rays_, hits_);
    auto through = glass.begin();
    sightings_.clear();
    for (uint32_t i = 0; i < hits_.size(); ++i) {
      if (hits_[i].triangle != kNoTriangle) sightings_.push_back({i, hits_[i], true});
      for (; through != glass.end() && through->ray == i; ++through) {
        sightings_.push_back({i, {0, through->triangle}, false});
      }
    }
  }

  /// Sightings that would change the set, by triangle, of each in ascending index of their rays. Distances of
  /// glass, which only gaps ask for, are filled in.
  std::vector<uint32_t> listCandidates() {
    std::vector<uint32_t> candidates;
    for (uint32_t i = 0; i < sightings_.size(); ++i) {
      Sighting& s = sightings_[i];
      const auto found = set_.find(s.hit.triangle);
      if (found != set_.end() && batch_[s.ray].index >= found->second.index) continue;
      if (!s.ends_ray) {
        const Corners c = cornersOf(scene_, s.hit.triangle);
        s.hit.t = intersectTriangle(shearRay(rays_[s.ray]), c.a, c.b, c.c);
      }
      candidates.push_back(i);
    }
    std::sort(candidates.begin(), candidates.end(), [&](uint32_t a, uint32_t b) {
      const Sighting &x = sightings_[a], &y = sightings_[b];
      return x.hit.triangle != y.hit.triangle ? x.hit.triangle < y.hit.triangle
                                              : batch_[x.ray].index < batch_[y.ray].index;
    });
    return candidates;
  }

  /// Some of listCandidates, all of one triangle.
  struct CandidateRun {
    uint32_t next, end;
  };
  std::vector<CandidateRun> runsOf(const std::vector<uint32_t>& candidates) const {
    std::vector<CandidateRun> runs;
    const auto triangle = [&](uint32_t i) { return sightings_[candidates[i]].hit.triangle; };
    for (uint32_t i = 0; i < candidates.size(); ++i) {
      if (i == 0 || triangle(i) != triangle(i - 1)) runs.push_back({i, i});
      runs.back().end = i + 1;
    }
    return runs;
  }

  /// Tests the chunk's candidates for gaps: of each triangle the first, then the next two, the next four, ...
  /// until one counts.
  void dropPinched(EachCandidate tested) {
    const std::vector<uint32_t> candidates = listCandidates();
    std::vector<CandidateRun> runs = runsOf(candidates);
    for (uint32_t most = tested == EachCandidate::kTested ? ~0u : 1; !runs.empty(); most *= 2) {
      std::vector<Ray> rays;
      std::vector<Hit> hits;
      const auto endOf = [&](const CandidateRun& run) {
        return run.end - run.next < most ? run.end : run.next + most;
      };
      for (const CandidateRun& run : runs) {
        for (uint32_t i = run.next; i < endOf(run); ++i) {
          rays.push_back(rays_[sightings_[candidates[i]].ray]);
          hits.push_back(sightings_[candidates[i]].hit);
        }
      }
      std::vector<Pinch> pinches;
      rays_traced_ += findPinched(*inner_, scene_, smallest_hole_, rays, hits, pinches);
      size_t at = 0;
      std::erase_if(runs, [&](CandidateRun& run) {
        bool any_counts = false;
        for (const uint32_t end = endOf(run); run.next < end; ++run.next, ++at) {
          Sighting& sighting = sightings_[candidates[run.next]];
          any_counts = any_counts || !pinches[at].pinched;
          if (!pinches[at].pinched) continue;
          sighting.counts = false;
          if (sighting.ends_ray) hits_[sighting.ray] = pinches[at].nearer;
        }
        return run.next == run.end || any_counts;
      });
    }
  }

  std::unique_ptr<Device> inner_;
  const Scene& scene_;
  float smallest_hole_;
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
  std::vector<Sighting> sightings_;
};

}  // namespace

std::unique_ptr<Device> makeNaiveDevice(std::unique_ptr<Device> inner, const Scene& scene,
                                        float smallest_hole) {
  return std::make_unique<NaiveDevice>(std::move(inner), scene, smallest_hole);
}

}  // namespace sightline
