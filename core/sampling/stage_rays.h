#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/shared/gvs_border.h"
#include "core/shared/gvs_reverse.h"
#include "core/shared/random_ray.h"
#include "core/shared/reverse.h"
#include "core/shared/types.h"

// The rays of the sampling stages on the host: for the cpu device and for whoever wants to trace the rays of
// a bake by other means.
#include "core/shared/stage_glue.inl"
namespace sightline {

/// A ray with its index (1 ..) in a batch.
struct BatchRay {
  Ray ray;
  uint32_t index;
};

/// The random rays of a segment on one face by slot; without direction where the slot has none. Call it with
/// ascending slots.
class SlotRays {
 public:
  SlotRays(const RandomSegment& segment, const Face& face, uvec4 shifts)
      : segment_(&segment), face_(face), shifts_(shifts), walk_(startSlotWalk()) {}

  BatchRay operator()(uint32_t slot) {
    walk_ = walkToSlot(walk_, *segment_, slot);
    const uint32_t offset = walkOffset(walk_, *segment_, slot);
    return {offsetRay(*segment_, face_, shifts_, offset), segment_->batch.x + offset};
  }

 private:
  const RandomSegment* segment_;
  Face face_;
  uvec4 shifts_;
  SlotWalk walk_;
};

inline Corners cornersOf(const Scene& scene, uint32_t triangle) {
  const auto corners = scene.corners(triangle);
  return {corners[0], corners[1], corners[2]};
}

inline vec3 entryOrigin(const PvsEntry& entry) {
  return vectorOfBits(entry.origin_triangle);
}

/// Samples between the ends of each long edge of the border polygon of an entry's triangle.
inline uint32_t borderSamplesOf(const Scene& scene, const PvsEntry& entry, const StageParams& params) {
  const Corners t = cornersOf(scene, entry.origin_triangle.w);
  return borderSamples(t.a, t.b, t.c, entryOrigin(entry), params);
}

/// Side 0, 1 or 2 of the border polygon of an entry's triangle, seen from where the entry's ray began.
inline BorderEdge borderEdgeOf(const Scene& scene, const PvsEntry& entry, uint32_t side,
                               const StageParams& params) {
  const Corners t = cornersOf(scene, entry.origin_triangle.w);
  return borderEdge(t.a, t.b, t.c, side, entryOrigin(entry), params);
}

/// Border ray k of an entry. samples: borderSamplesOf.
inline Ray borderRayOf(const Scene& scene, const PvsEntry& entry, uint32_t k, uint32_t samples,
                       const StageParams& params) {
  const Corners t = cornersOf(scene, entry.origin_triangle.w);
  return polygonRay(t.a, t.b, t.c, k, samples, entryOrigin(entry), params);
}

/// How many border rays the entries have before each of them, and one number more: in all.
inline std::vector<uint64_t> borderStarts(const Scene& scene, std::span<const PvsEntry> entries,
                                          const StageParams& params) {
  std::vector<uint64_t> starts{0};
  starts.reserve(entries.size() + 1);
  for (const PvsEntry& entry : entries) {
    starts.push_back(starts.back() + borderRayCount(borderSamplesOf(scene, entry, params), params));
  }
  return starts;
}

/// So many entries a batch of border rays looks at: more than it can take, but not the whole list. Their rays
/// can be counted in 32 bits.
inline uint32_t mostBorderEntries(uint32_t most_rays, const StageParams& params) {
  const uint32_t fewest = borderRayCount(std::min(kFewestBorderSamples, params.counts.x), params);
  const uint32_t countable = ~0u / borderRayCount(params.counts.x, params) / kBorderBlock * kBorderBlock;
  return std::min(most_rays / fewest / kBorderBlock * kBorderBlock + kBorderBlock, countable);
}

/// How many of the entries a batch of most_rays takes: whole blocks of kBorderBlock, one at least. starts: of
/// borderStarts, for all that there are.
inline uint32_t borderBatchEntries(std::span<const uint64_t> starts, uint32_t most_rays) {
  const auto count = static_cast<uint32_t>(starts.size() - 1);
  uint32_t entries = std::min(kBorderBlock, count);
  while (entries < count && starts[std::min(entries + kBorderBlock, count)] <= most_rays) {
    entries = std::min(entries + kBorderBlock, count);
  }
  return entries;
}

/// The border rays of entries by number. Remembers the last polygon, so call it with ascending numbers.
class BorderRays {
 public:
  /// starts: borderStarts of the entries.
  BorderRays(const Scene& scene, std::span<const PvsEntry> entries, std::span<const uint64_t> starts,
             const StageParams& params)
      : scene_(&scene), entries_(entries), starts_(starts), params_(&params) {}

  /// Which entry's border ray it is.
  uint32_t entryOf(uint32_t number) const {
    return uint32_t(std::upper_bound(starts_.begin(), starts_.end(), number) - starts_.begin() - 1);
  }
  /// Which ray of its entry's polygon.
  uint32_t rayOf(uint32_t number, uint32_t entry) const { return uint32_t(number - starts_[entry]); }

  Ray operator()(uint32_t number) {
    if (made_ == 0 || number < starts_[entry_] || number >= starts_[entry_ + 1]) {
      entry_ = entryOf(number);
      made_ = 0;
    }
    return borderRayAt(*this, entry_, rayOf(number, entry_));
  }

  // What borderRayAt reads.
  const StageParams& params() const { return *params_; }
  uint32_t border_first() const { return 0; }
  const PvsEntry& entries(uint32_t entry) const { return entries_[entry]; }
  const BorderEdge& border_edges(uint32_t number) {
    const uint32_t side = number - entry_ * 3;
    if ((made_ >> side & 1) == 0) sides_[side] = borderEdgeOf(*scene_, entries_[entry_], side, *params_);
    made_ |= 1u << side;
    return sides_[side];
  }

 private:
  const Scene* scene_;
  std::span<const PvsEntry> entries_;
  std::span<const uint64_t> starts_;
  const StageParams* params_;
  uint32_t entry_ = 0;
  uint32_t made_ = 0;  ///< which sides of the entry's polygon there are, a bit each
  BorderEdge sides_[3];
};

/// The border rays of one level of the original method by slot; positions between samples that hit the same
/// have no direction. Call it with ascending slots.
class GvsLevelRays {
 public:
  /// hits: of the batch's rays by number, of the levels before; kNotTraced where there was none.
  GvsLevelRays(uint32_t level, const BorderRays& rays, std::span<const uint32_t> hits)
      : level_(level), rays_(rays), hits_(hits) {}

  BatchRay operator()(uint32_t slot) {
    const uint32_t first = slot / gvsSlots(level_) * kGvsPositions;
    const uint32_t position = gvsPosition(level_, slot % gvsSlots(level_));
    const bool divides = level_ == 0 || gvsDivides(hits_[first + gvsBefore(level_, position)],
                                                   hits_[first + gvsAfter(level_, position)]);
    return divides ? BatchRay{rays_(first + position), first + position + 1} : BatchRay{noRay(), 0};
  }

 private:
  uint32_t level_;
  BorderRays rays_;
  std::span<const uint32_t> hits_;
};

/// Whether a border ray of the entry meets a discontinuity.
inline bool isDiscontinuityOf(const Scene& scene, const PvsEntry& entry, const Ray& ray, const Hit& hit,
                              const StageParams& params) {
  if (!isGvs(params)) return isDiscontinuity(ray, hit, params);
  const Corners t = cornersOf(scene, entry.origin_triangle.w);
  return isGvsDiscontinuity(ray, hit, t.a, t.b, t.c, params);
}

/// Appends the discontinuities of a batch that get reverse rays. pending: the list's entries from `first` on;
/// starts: borderStarts of those of the batch; by the rays' numbers, hits: what they hit, and
/// is_discontinuity: isDiscontinuityOf.
inline void appendDiscontinuitiesOf(const Scene& scene, std::span<const PvsEntry> pending, uint32_t first,
                                    std::span<const uint64_t> starts, std::span<const uint32_t> hits,
                                    std::span<const uint8_t> is_discontinuity, const StageParams& params,
                                    std::vector<Discontinuity>& list) {
  for (uint32_t e = 0; e + 1 < starts.size(); ++e) {
    const uint32_t samples = borderSamplesOf(scene, pending[e], params);
    for (uint64_t index = starts[e]; index < starts[e + 1]; ++index) {
      if (is_discontinuity[index] == 0) continue;
      const auto k = static_cast<uint32_t>(index - starts[e]);
      const uint32_t place = borderPlace(k, samples);
      const bool follows = place > 0 && is_discontinuity[index - 1] != 0 && hits[index - 1] == hits[index];
      if (!isGvs(params) && !keepsDiscontinuity(place, follows, params)) continue;
      list.push_back({uvec4(first + e, k, hits[index], samples)});
    }
  }
}

/// What the glue of reverse and random rays reads.
struct HostStage {
  const Scene* scene = nullptr;
  std::span<const Face> face_list = {};
  const StageParams* stage_params = nullptr;
  std::span<const PvsEntry> entry_list = {};         ///< the whole list
  std::span<const Discontinuity> waiting = {};       ///< that get reverse rays
  uint64_t first_number = 0;                         ///< running number of the first of them in the cell
  std::span<const RandomSegment> segment_list = {};  ///< of the batch

  const StageParams& params() const { return *stage_params; }
  uint64_t items_before() const { return first_number; }
  uint32_t segment_count() const { return static_cast<uint32_t>(segment_list.size()); }
  const Face& faces(uint32_t i) const { return face_list[i]; }
  const PvsEntry& entries(uint32_t i) const { return entry_list[i]; }
  const Discontinuity& discontinuities(uint32_t i) const { return waiting[i]; }
  const RandomSegment& segments(uint32_t i) const { return segment_list[i]; }
  Corners corners(uint32_t triangle) const { return cornersOf(*scene, triangle); }
};

/// The reverse rays of the stage's discontinuities by number, reverseRayCount each. Remembers the last item,
/// so call it with ascending numbers.
class ReverseRays : public HostStage {
 public:
  explicit ReverseRays(const HostStage& stage) : HostStage(stage) {}

  BatchRay operator()(uint32_t number) { return {reverseRayAt(*this, number), number + 1}; }

  // What reverseRayAt reads besides.
  const ReverseItem& reverse_items(uint32_t place) {
    if (place_ != place) item_ = reverseItemAt(*this, place_ = place);
    return item_;
  }

 private:
  uint32_t place_ = kNoTriangle;  ///< which discontinuity's item there is
  ReverseItem item_{};
};

}  // namespace sightline
