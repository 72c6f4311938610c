#pragma once
#include <span>

#include "core/scene/scene.h"
#include "core/shared/border.h"
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

/// Side 0, 1 or 2 of the border polygon of an entry's triangle, seen from where the entry's ray began.
inline BorderEdge borderEdgeOf(const Scene& scene, const PvsEntry& entry, uint32_t side,
                               const StageParams& params) {
  const uint32_t triangle = entry.origin_triangle.w;
  return borderEdge(cornerOf(scene, triangle, 0), cornerOf(scene, triangle, 1), cornerOf(scene, triangle, 2),
                    side, entryOrigin(entry), params);
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

/// Reverse ray k of a discontinuity; without direction where no face looks at it or its start point sees
/// nothing but the occluder.
inline Ray reverseRayOf(const ReverseItem& item, std::span<const Face> faces, uint32_t k,
                        const StageParams& params) {
  if (item.number.z == 0) return noRay();
  return reverseRay(item, faces[reverseFace(item, k)], k, params);
}

}  // namespace sightline
