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

inline vec3 cornerOf(const Scene& scene, uint32_t triangle, int corner) {
  return scene.positions[scene.triangles[triangle][corner]];
}

inline vec3 entryOrigin(const PvsEntry& entry) {
  const uvec4 bits = entry.origin_triangle;
  return vec3(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z));
}

/// The ray that found the entry's triangle.
inline Ray entryRay(const PvsEntry& entry) {
  const uvec4 bits = entry.direction_stage;
  return {vec4(entryOrigin(entry), 0),
          vec4(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z), 0)};
}

/// Samples between the ends of each long edge of the border polygon of an entry's triangle.
inline uint32_t borderSamplesOf(const Scene& scene, const PvsEntry& entry, const StageParams& params) {
  const uint32_t triangle = entry.origin_triangle.w;
  return borderSamples(cornerOf(scene, triangle, 0), cornerOf(scene, triangle, 1),
                       cornerOf(scene, triangle, 2), entryOrigin(entry), params);
}

/// Side 0, 1 or 2 of the border polygon of an entry's triangle, seen from where the entry's ray began.
inline BorderEdge borderEdgeOf(const Scene& scene, const PvsEntry& entry, uint32_t side,
                               const StageParams& params) {
  const uint32_t triangle = entry.origin_triangle.w;
  return borderEdge(cornerOf(scene, triangle, 0), cornerOf(scene, triangle, 1), cornerOf(scene, triangle, 2),
                    side, entryOrigin(entry), params);
}

/// Border ray k of an entry. samples: borderSamplesOf.
inline Ray borderRayOf(const Scene& scene, const PvsEntry& entry, uint32_t k, uint32_t samples,
                       const StageParams& params) {
  const uint32_t triangle = entry.origin_triangle.w;
  return polygonRay(cornerOf(scene, triangle, 0), cornerOf(scene, triangle, 1), cornerOf(scene, triangle, 2),
                    k, samples, entryOrigin(entry), params);
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
      samples_ = borderSamplesOf(*scene_, entries_[entry_], *params_);
      made_ = 0;
    }
    const uint32_t k = rayOf(number, entry_);
    const vec3 origin = entryOrigin(entries_[entry_]);
    if (isGvs(*params_)) {
      const uint32_t first = gvsFirstVertex(k), second = gvsSecondVertex(k);
      const vec3 from = gvsVertexOf(side(first / 3), first);
      return gvsBorderRay(from, gvsVertexOf(side(second / 3), second), k, origin, *params_);
    }
    return borderRay(side(borderSide(k, samples_)), k, origin, *params_);
  }

 private:
  const BorderEdge& side(uint32_t side) {
    if ((made_ >> side & 1) == 0) sides_[side] = borderEdgeOf(*scene_, entries_[entry_], side, *params_);
    made_ |= 1u << side;
    return sides_[side];
  }

  const Scene* scene_;
  std::span<const PvsEntry> entries_;
  std::span<const uint64_t> starts_;
  const StageParams* params_;
  uint32_t entry_ = 0, samples_ = 0;
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
  const uint32_t t = entry.origin_triangle.w;
  return isGvsDiscontinuity(ray, hit, cornerOf(scene, t, 0), cornerOf(scene, t, 1), cornerOf(scene, t, 2),
                            params);
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

/// The item of a discontinuity of gvs++ for its reverse rays. border: the ray that met it; number: its
/// running number in the cell.
inline ReverseItem reverseItemOf(const Scene& scene, std::span<const Face> faces, const Ray& border,
                                 uint32_t occluder, uint64_t number) {
  const vec3 target = add3(xyz3(border.origin), xyz3(border.direction));
  uint32_t mask = 0;
  for (size_t f = 0; f < faces.size(); ++f) mask |= (faceLooksAt(faces[f], target) ? 1u : 0u) << f;
  const ReverseItem item = openItem(target, number, mask);
  if (occluder == kNoTriangle) return item;
  return occludedItem(item, cornerOf(scene, occluder, 0), cornerOf(scene, occluder, 1),
                      cornerOf(scene, occluder, 2));
}

/// The item of a discontinuity that waits, by the method of the parameters. entries: the whole list.
inline ReverseItem reverseItemOf(const Scene& scene, std::span<const Face> faces,
                                 std::span<const PvsEntry> entries, const Discontinuity& discontinuity,
                                 uint64_t number, const StageParams& params) {
  const uvec4 ray = discontinuity.ray;
  const PvsEntry& entry = entries[ray.x];
  const Ray border = borderRayOf(scene, entry, ray.y, ray.w, params);
  const ReverseItem item = reverseItemOf(scene, faces, border, ray.z, number);
  if (!isGvs(params)) return item;
  const uint32_t t = entry.origin_triangle.w;
  return gvsReverseItem(item, entryRay(entry), cornerOf(scene, t, 0), cornerOf(scene, t, 1),
                        cornerOf(scene, t, 2), params);
}

/// Reverse ray k of a discontinuity; without direction where no face looks at it, or its start point sees
/// nothing but the occluder, or, in the original method, lies outside the cell, or the cell does not look.
inline Ray reverseRayOf(const ReverseItem& item, std::span<const Face> faces, uint32_t k,
                        const StageParams& params) {
  if (item.number.z == 0) return noRay();
  if (!isGvs(params)) return reverseRay(item, faces[reverseFace(item, k)], k, params);
  Ray ray = noRay();
  for (size_t f = 0; f < faces.size() && !hasDirection(ray); ++f) {
    ray = gvsReverseRay(item, faces[f], k, params);
  }
  return ray;
}

/// The reverse rays of discontinuities by number, reverseRayCount each. Remembers the last item, so call it
/// with ascending numbers.
class ReverseRays {
 public:
  /// entries: the whole list; first_number: running number of the first discontinuity in the cell.
  ReverseRays(const Scene& scene, std::span<const Face> faces, std::span<const PvsEntry> entries,
              std::span<const Discontinuity> discontinuities, uint64_t first_number,
              const StageParams& params)
      : scene_(&scene),
        faces_(faces),
        entries_(entries),
        discontinuities_(discontinuities),
        first_number_(first_number),
        params_(&params) {}

  BatchRay operator()(uint32_t number) {
    const uint32_t per_item = reverseRayCount(*params_);
    if (place_ != number / per_item) {
      place_ = number / per_item;
      item_ = reverseItemOf(*scene_, faces_, entries_, discontinuities_[place_], first_number_ + place_,
                            *params_);
    }
    return {reverseRayOf(item_, faces_, number % per_item, *params_), number + 1};
  }

 private:
  const Scene* scene_;
  std::span<const Face> faces_;
  std::span<const PvsEntry> entries_;
  std::span<const Discontinuity> discontinuities_;
  uint64_t first_number_;
  const StageParams* params_;
  uint32_t place_ = kNoTriangle;  ///< which discontinuity's item there is
  ReverseItem item_{};
};

}  // namespace sightline
