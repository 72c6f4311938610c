#include "core/device/cpu/cpu_device.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <bit>
#include <utility>

#include "core/base/error.h"
#include "core/device/cpu/host_set.h"
#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {
namespace {

/// Rays that are traced together, and packets that a thread takes at a time.
constexpr uint32_t kPacket = 8;
constexpr size_t kGrain = 64;
/// Rays whose glass is listed together.
constexpr size_t kGlassRays = 256;

/// What a ray sees.
struct Sight {
  Hit hit;                     ///< what ends it
  std::span<const Hit> glass;  ///< before that
};

void insertSight(SetRef set, const Sight& sight, uint32_t ray_index) {
  insertHit(set, sight.hit.triangle, ray_index);
  for (const Hit& hit : sight.glass) insertHit(set, hit.triangle, ray_index);
}

class CpuDevice final : public Device {
  // Generators first: their types are deduced.
  auto slotRays(const RandomSegment& segment, uvec4 shifts) const {
    return SlotRays(segment, faces_.at(segment.range.x), shifts);
  }

  BorderRays borderBatch() const {
    return {scene_, std::span(entries_).subspan(border_first_), border_starts_, params_};
  }

  /// Generator of the border rays of the last traceBorder.
  auto borderRays() const {
    return [rays = borderBatch()](uint32_t number) mutable { return BatchRay{rays(number), number + 1}; };
  }

  /// Generator of the reverse rays of the last traceReverse; excluded ones have no direction.
  auto reverseRays() const {
    return ReverseRays({&scene_, faces_, &params_, entries_,
                        std::span(discontinuities_).subspan(reverse_first_), items_before_ + reverse_first_});
  }

 public:
  CpuDevice(const Scene& scene, const Bvh& bvh, const DeviceOptions& options)
      : scene_(scene),
        bvh_(bvh),
        tracer_(scene, bvh),
        arena_(static_cast<int>(threadCount(options))),
        set_(scene.triangleCount(), wantsHash(options)) {
    const uint64_t bytes = residentBytes() + set_.bytes();
    if (options.memory_budget_bytes == 0 || bytes <= options.memory_budget_bytes) return;
    throw Error(fmt::format("cpu: scene, tree and set take {} bytes, more than the {} of --memory-budget",
                            bytes, options.memory_budget_bytes));
  }

  DeviceInfo info() const override { return cpuDeviceInfo(); }

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    faces_.assign(faces.begin(), faces.end());
    params_ = params;
    set_.clear();
    entries_.clear();
    segments_.clear();
    rays_ = 0;
    items_before_ = 0;
    discontinuities_.clear();
  }

  void traceRandom(const RandomSegment& segment) override {
    segments_.push_back(segment);
    rays_ += launch(
        slotCount(segment), [&] { return slotRays(segment, params_.shifts); },
        [&](const BatchRay& ray, const Sight& sight, SetRef set) { insertSight(set, sight, ray.index); });
  }

  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    border_first_ = first;
    std::span<const PvsEntry> pending = std::span(entries_).subspan(first);
    pending = pending.first(std::min<size_t>(pending.size(), mostBorderEntries(most_rays, params_)));
    border_starts_ = borderStarts(scene_, pending, params_);
    const uint32_t count = borderBatchEntries(border_starts_, most_rays);
    border_starts_.resize(count + 1);
    const uint64_t total = border_starts_.back();
    is_discontinuity_.assign(total, 0);
    border_hits_.assign(total, isGvs(params_) ? kNotTraced : kNoTriangle);
    const BorderRays batch = borderBatch();
    const auto take = [&](const BatchRay& ray, const Sight& sight, SetRef set) {
      const Hit& hit = sight.hit;
      const uint32_t index = ray.index - 1;
      border_hits_[index] = hit.triangle;
      const PvsEntry& entry = entries_[first + batch.entryOf(index)];
      is_discontinuity_[index] = isDiscontinuityOf(scene_, entry, ray.ray, hit, params_) ? 1 : 0;
      insertSight(set, sight, ray.index);
    };
    if (isGvs(params_)) {
      for (uint32_t level = 0; level < kGvsLevels; ++level) {
        rays_ += launch(
            uint64_t(count) * gvsSlots(level),
            [&] { return GvsLevelRays(level, borderBatch(), border_hits_); }, take);
      }
    } else {
      rays_ += launch(
          total, [&] { return borderRays(); }, take);
    }
    const size_t before = discontinuities_.size();
    if (listing) {
      appendDiscontinuitiesOf(scene_, std::span(entries_).subspan(first), first, border_starts_, border_hits_,
                              is_discontinuity_, params_, discontinuities_);
    }
    return {count, static_cast<uint32_t>(discontinuities_.size() - before)};
  }

  void dropDiscontinuities() override {
    items_before_ += discontinuities_.size();
    discontinuities_.clear();
  }

  void traceReverse(uint32_t first, uint32_t count) override {
    reverse_first_ = first;
    rays_ += launch(
        uint64_t(count) * reverseRayCount(params_), [&] { return reverseRays(); },
        [&](const BatchRay& ray, const Sight& sight, SetRef set) { insertSight(set, sight, ray.index); });
  }

  uint32_t collect(uint32_t stage) override {
    const size_t before = entries_.size();
    const SetRef set = set_.ref();
    std::vector<uint32_t>& fresh = set_.fresh();
    for (size_t word = 0; word < fresh.size(); ++word) {
      for (uint32_t bits = std::exchange(fresh[word], 0u); bits != 0; bits &= bits - 1) {
        const uint32_t triangle =
            static_cast<uint32_t>(word * 32) + static_cast<uint32_t>(std::countr_zero(bits));
        uint32_t& winner = set.winner[findSlot(set, triangle)];
        const Ray ray = rayOfBatch(stage, winner);
        winner = kSlotOld;
        entries_.push_back(entryOf(triangle, ray, stage));
      }
    }
    segments_.clear();
    while (set_.isHash() && entries_.size() * 2 > set_.capacity()) set_.grow(2);
    return static_cast<uint32_t>(entries_.size() - before);
  }

  void insertContained(std::span<const uint32_t> triangles) override {
    for (const uint32_t triangle : triangles) {
      while (claimSlot(set_.ref(), triangle) == kSlotEmpty) set_.grow(2);
      set_.ref().winner[findSlot(set_.ref(), triangle)] = kSlotOld;
      entries_.push_back(entryOf(triangle, noRay(), kStageContained));
      while (set_.isHash() && entries_.size() * 2 > set_.capacity()) set_.grow(2);
    }
  }

  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    std::atomic<uint64_t> missing = 0;
    rays_ += launch(
        slotCount(segment), [&] { return slotRays(segment, shifts); },
        [&](const BatchRay&, const Sight& sight, SetRef set) {
          const auto lacks = [&](const Hit& hit) {
            return hit.triangle != kNoTriangle && !isInSet(set, hit.triangle);
          };
          if (lacks(sight.hit) || std::ranges::any_of(sight.glass, lacks)) missing.fetch_add(1);
        });
    return missing;
  }

  DeviceCounters counters() override {
    const uint64_t scratch = border_hits_.capacity() * 5 + border_starts_.capacity() * 8 +
                             discontinuities_.capacity() * sizeof(Discontinuity);
    return {rays_, residentBytes() + set_.bytes() + entries_.capacity() * sizeof(PvsEntry) + scratch,
            set_.isHash()};
  }

  std::vector<PvsEntry> readPvs() override { return entries_; }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    parallel((rays.size() + kPacket - 1) / kPacket, [&](size_t begin, size_t end) {
      const size_t first = begin * kPacket, last = std::min(end * kPacket, rays.size());
      tracer_.tracePacket(&rays[first], &hits[first], static_cast<int>(last - first));
    });
  }

  bool hasGlass() const override { return tracer_.features().glass; }

  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    std::vector<SeenThrough> seen;
    if (!tracer_.features().glass) return seen;
    std::vector<std::vector<SeenThrough>> parts((rays.size() + kGlassRays - 1) / kGlassRays);
    parallel(parts.size(), [&](size_t begin, size_t end) {
      std::vector<Hit> glass;
      for (size_t i = begin * kGlassRays; i < std::min(end * kGlassRays, rays.size()); ++i) {
        tracer_.traceThrough(rays[i], glass);
        for (const Hit& hit : glass) {
          if (hits[i].triangle != kNoTriangle && hit.t > hits[i].t) continue;
          parts[i / kGlassRays].push_back({static_cast<uint32_t>(i), hit.triangle});
        }
      }
    });
    for (const auto& part : parts) seen.insert(seen.end(), part.begin(), part.end());
    return seen;
  }

  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    const uint32_t view_packets = viewItems(resolution) / kPacket;
    const size_t view_pixels = size_t(resolution) * resolution;
    parallel(views.size() * view_packets, [&](size_t begin, size_t end) {
      Ray rays[kPacket];
      Hit hits[kPacket];
      uint32_t pixels[kPacket];
      for (size_t packet = begin; packet < end; ++packet) {
        const size_t view = packet / view_packets;
        const auto first = static_cast<uint32_t>(packet % view_packets) * kPacket;
        for (uint32_t lane = 0; lane < kPacket; ++lane) {
          const uint32_t pixel = pixels[lane] = viewPixel(first + lane, resolution);
          rays[lane] = pixel == kNoTriangle
                           ? noRay()
                           : viewRay(views[view], pixel % resolution, pixel / resolution, resolution);
        }
        tracer_.tracePacket(rays, hits, kPacket);
        for (uint32_t lane = 0; lane < kPacket; ++lane) {
          if (pixels[lane] != kNoTriangle) triangles[view * view_pixels + pixels[lane]] = hits[lane].triangle;
        }
      }
    });
  }

 private:
  /// Tree and triangles.
  uint64_t residentBytes() const {
    return tracer_.memoryBytes() + bvh_.nodes2.size() * sizeof(BvhNode2) +
           bvh_.nodes8.size() * sizeof(BvhNode8) + bvh_.instances.size() * sizeof(InstanceRecord);
  }

  static size_t threadCount(const DeviceOptions& options) {
    return static_cast<size_t>(options.threads > 0 ? options.threads : tbb::info::default_concurrency());
  }

  bool wantsHash(const DeviceOptions& options) const {
    if (options.set != SetKind::kAuto) return options.set == SetKind::kHash;
    return options.memory_budget_bytes > 0 &&
           residentBytes() + uint64_t(scene_.triangleCount()) * 4 > options.memory_budget_bytes;
  }

  void parallel(size_t count, auto&& body) {
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kGrain),
                        [&](const tbb::blocked_range<size_t>& range) { body(range.begin(), range.end()); });
    });
  }

  /// Traces the rays 0 .. count - 1 of generators that makeGenerator() returns (each is called with ascending
  /// numbers by one thread), packet by packet, and hands those that have a direction with what they see to
  /// take(ray, sight, set); again with a larger set if it was full (insertion is idempotent). Returns the
  /// rays of one full run.
  uint64_t launch(uint64_t count, auto&& makeGenerator, auto&& take) {
    for (;;) {
      std::atomic<uint64_t> total = 0;
      const SetRef set = set_.ref();
      parallel((count + kPacket - 1) / kPacket, [&](size_t begin, size_t end) {
        auto generate = makeGenerator();
        BatchRay batch[kPacket];
        Ray rays[kPacket];
        Hit hits[kPacket];
        std::vector<Hit> glass;
        uint64_t traced = 0;
        for (size_t packet = begin; packet < end; ++packet) {
          const auto first = static_cast<uint32_t>(packet * kPacket);
          const auto lanes = static_cast<uint32_t>(std::min<uint64_t>(kPacket, count - packet * kPacket));
          for (uint32_t lane = 0; lane < lanes; ++lane) {
            batch[lane] = generate(first + lane);
            rays[lane] = batch[lane].ray;
          }
          if (!tracer_.features().glass) tracer_.tracePacket(rays, hits, static_cast<int>(lanes));
          for (uint32_t lane = 0; lane < lanes; ++lane) {
            if (!hasDirection(rays[lane])) continue;
            ++traced;
            if (tracer_.features().glass) hits[lane] = tracer_.traceThrough(rays[lane], glass);
            take(batch[lane], Sight{hits[lane], glass}, set);
          }
        }
        total.fetch_add(traced, std::memory_order_relaxed);
      });
      if (!set_.takeOverflow()) return total;
      set_.grow(4);
    }
  }

  /// The ray with this index (1 ..) in the batch that is being collected.
  Ray rayOfBatch(uint32_t stage, uint32_t index) const {
    if (stage == kStageBorder) return borderRays()(index - 1).ray;
    if (stage == kStageReverse) return reverseRays()(index - 1).ray;
    return segmentRayAt(HostStage{.face_list = faces_, .stage_params = &params_, .segment_list = segments_},
                        index);
  }

  const Scene& scene_;
  const Bvh& bvh_;
  CpuTracer tracer_;
  tbb::task_arena arena_;
  HostSet set_;
  std::vector<Face> faces_;
  StageParams params_{};
  std::vector<PvsEntry> entries_;
  std::vector<RandomSegment> segments_;    ///< of the batch
  uint32_t border_first_ = 0;              ///< entry of the first border ray
  std::vector<uint64_t> border_starts_;    ///< of the batch: borderStarts
  std::vector<uint32_t> border_hits_;      ///< a border ray: the triangle that it hit
  std::vector<uint8_t> is_discontinuity_;  ///< a border ray
  std::vector<Discontinuity> discontinuities_;
  uint64_t items_before_ = 0;  ///< discontinuities of the cell that were dropped
  uint32_t reverse_first_ = 0;
  uint64_t rays_ = 0;
};

}  // namespace

std::unique_ptr<Device> makeCpuDevice(const Scene& scene, const Bvh& bvh, const DeviceOptions& options) {
  return std::make_unique<CpuDevice>(scene, bvh, options);
}

DeviceInfo cpuDeviceInfo() {
  DeviceInfo info;
  info.id = "cpu";
  info.name = fmt::format("host processor, {} threads", tbb::info::default_concurrency());
  info.driver = "built in";
  info.layout = "8-wide, single rays";
  info.on_cpu = true;
  info.exact = true;
  return info;
}

}  // namespace sightline
