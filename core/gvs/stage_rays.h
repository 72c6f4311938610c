#pragma once
#include <span>

#include "core/scene/scene.h"
#include "core/shared/border.h"
#include "core/shared/gvs_reverse.h"
#include "core/shared/reverse.h"
#include "core/shared/types.h"

// The rays of border and reverse sampling on the host: for the cpu device and for whoever wants to trace the
// rays of a bake by other means.
namespace sightline {

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

/// Side 0, 1 or 2 of the border polygon of an entry's triangle, seen from where the entry's ray began.
inline BorderEdge borderEdgeOf(const Scene& scene, const PvsEntry& entry, uint32_t side,
                               const StageParams& params) {
  const uint32_t triangle = entry.origin_triangle.w;
  return borderEdge(cornerOf(scene, triangle, 0), cornerOf(scene, triangle, 1), cornerOf(scene, triangle, 2),
                    side, entryOrigin(entry), params);
}

/// The border rays of entries by number: borderRayCount rays each. Remembers the last polygon, so call it
/// with ascending numbers.
class BorderRays {
 public:
  BorderRays(const Scene& scene, std::span<const PvsEntry> entries, const StageParams& params)
      : scene_(&scene), entries_(entries), params_(&params) {}

  Ray operator()(uint32_t number) {
    const uint32_t per_entry = borderRayCount(*params_);
    const uint32_t entry = number / per_entry, k = number % per_entry;
    const vec3 origin = entryOrigin(entries_[entry]);
    if (isGvs(*params_)) {
      const uint32_t first = gvsFirstVertex(k), second = gvsSecondVertex(k);
      const vec3 from = gvsVertexOf(side(entry, first / 3), first);
      return rayTo(origin, gvsPoint(from, gvsVertexOf(side(entry, second / 3), second), k));
    }
    return borderRay(side(entry, borderSide(k, *params_)), k, origin, *params_);
  }

 private:
  const BorderEdge& side(uint32_t entry, uint32_t side) {
    if (entry_ != entry) made_ = 0;
    entry_ = entry;
    if ((made_ >> side & 1) == 0) sides_[side] = borderEdgeOf(*scene_, entries_[entry], side, *params_);
    made_ |= 1u << side;
    return sides_[side];
  }

  const Scene* scene_;
  std::span<const PvsEntry> entries_;
  const StageParams* params_;
  uint32_t entry_ = 0, made_ = 0;  ///< whose sides there are, a bit each
  BorderEdge sides_[3];
};

/// Whether a border ray of the entry meets a discontinuity.
inline bool isDiscontinuityOf(const Scene& scene, const PvsEntry& entry, const Ray& ray, const Hit& hit,
                              const StageParams& params) {
  if (!isGvs(params)) return isDiscontinuity(ray, hit, params);
  const uint32_t t = entry.origin_triangle.w;
  return isGvsDiscontinuity(ray, hit, cornerOf(scene, t, 0), cornerOf(scene, t, 1), cornerOf(scene, t, 2),
                            params);
}

/// The discontinuity that a border ray met. occluder: the triangle that it hit, or kNoTriangle; number: its
/// running number in the cell.
inline ReverseItem reverseItemOf(const Scene& scene, std::span<const Face> faces, const Ray& border,
                                 uint32_t occluder, uint64_t number) {
  const vec3 target = add3(xyz3(border.origin), xyz3(border.direction));
  uint32_t mask = 0;
  for (size_t f = 0; f < faces.size(); ++f) mask |= (faceLooksAt(faces[f], target) ? 1u : 0u) << f;
  ReverseItem item{};
  item.target = vec4(target, 0);
  item.number = uvec4(static_cast<uint32_t>(number), static_cast<uint32_t>(number >> 32), mask,
                      occluder != kNoTriangle ? 1 : 0);
  if (occluder != kNoTriangle) {
    item.a = vec4(cornerOf(scene, occluder, 0), 0);
    item.b = vec4(cornerOf(scene, occluder, 1), 0);
    item.c = vec4(cornerOf(scene, occluder, 2), 0);
  }
  return item;
}

/// The same by the method of the parameters. entry: whose border ray it was.
inline ReverseItem reverseItemOf(const Scene& scene, std::span<const Face> faces, const PvsEntry& entry,
                                 const Ray& border, uint32_t occluder, uint64_t number,
                                 const StageParams& params) {
  const ReverseItem item = reverseItemOf(scene, faces, border, occluder, number);
  if (!isGvs(params)) return item;
  const uint32_t t = entry.origin_triangle.w;
  return gvsReverseItem(item, entryRay(entry), cornerOf(scene, t, 0), cornerOf(scene, t, 1),
                        cornerOf(scene, t, 2), params);
}

/// Reverse ray k of a discontinuity; without direction where no face looks at it, or its start point sees
/// nothing but the occluder, or, in the original method, lies outside the cell.
inline Ray reverseRayOf(const ReverseItem& item, std::span<const Face> faces, uint32_t k,
                        const StageParams& params) {
  if (item.number.z == 0) return noRay();
  if (!isGvs(params)) return reverseRay(item, faces[reverseFace(item, k)], k, params);
  Ray ray = noRay();
  for (size_t f = 0; f < faces.size() && !hasDirection(ray); ++f) ray = gvsReverseRay(item, faces[f], k);
  return ray;
}

}  // namespace sightline
