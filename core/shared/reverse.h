// Reverse sampling: rays from all over the view cell to the place of a discontinuity, past its occluder
// (thesis 5.3.2, algorithm 6.3).
//
// Differences from the thesis: a point is excluded only if the segment from it to the target really meets the
// occluder (the thesis projects the occluder onto the cell's plane, which fails where the target lies between
// the two); samples of a box are dealt out over all faces that look at the target; sample points differ from
// one discontinuity to the next.
#ifndef SL_REVERSE_H
#define SL_REVERSE_H
#include "core/shared/halton.h"
#include "core/shared/look.h"
#include "core/shared/triangle.h"
SL_NAMESPACE_BEGIN

/// Rays for one discontinuity: 4 n_RSEdge + n_RSArea; 2 of the original method.
SL_FUNC uint reverseRayCount(StageParams params) {
  return isGvs(params) ? 2u : 4u * params.counts.y + params.counts.z;
}

SL_FUNC bool faceLooksAt(Face face, vec3 target) {
  return dot3(sub3(target, xyz3(face.corner)), xyz3(face.normal)) > 0.0f;
}

/// Where ray k starts on the face: along the four edges, corners included, then inside by Halton points.
/// item: running number of the discontinuity in the cell.
SL_FUNC vec3 reverseOrigin(Face face, uint64 item, uint k, StageParams params) {
  uint n_edge = params.counts.y;
  float u = 0.0f;
  float v = 0.0f;
  if (k < 4u * n_edge) {
    uint edge = k / n_edge;
    uint place = k - edge * n_edge;
    float jitter = place == 0u ? 0.0f : haltonFraction(halton2(item, params.shifts.y));
    float along = slDivide(slFloat(place) + jitter, slFloat(n_edge));
    u = edge == 0u ? along : (edge == 1u ? 1.0f : (edge == 2u ? 1.0f - along : 0.0f));
    v = edge == 0u ? 0.0f : (edge == 1u ? along : (edge == 2u ? 1.0f : 1.0f - along));
  } else {
    uint64 index = item * params.counts.z + slUint64(k - 4u * n_edge);
    u = haltonFraction(halton2(index, params.shifts.x));
    v = haltonFraction(halton3(index, params.shifts.y));
  }
  return add3(add3(xyz3(face.corner), scale3(xyz3(face.edge_u), u)), scale3(xyz3(face.edge_v), v));
}

/// A discontinuity as it waits for its reverse rays.
SL_STRUCT(Discontinuity) {
  uvec4 ray;  ///< x: entry whose border ray met it, y: which ray of its polygon, z: what was hit: a triangle
              ///< or kNoTriangle, w: samples between the ends of the polygon's long edges
};

/// A discontinuity: all that its reverse rays have in common.
SL_STRUCT(ReverseItem) {
  vec4 target;  ///< xyz
  vec4 a;       ///< corners of the occluder; of the original method: see gvs_reverse.h
  vec4 b;
  vec4 c;
  uvec4 number;  ///< x, y: low and high half of its running number in the cell; z: bits of the faces that
                 ///< look at the target; w: 1 if there is an occluder
};

/// The item of a target, as if there were no occluder. number: running number; mask: bits of the faces that
/// look at the target.
SL_FUNC ReverseItem openItem(vec3 target, uint64 number, uint mask) {
  ReverseItem item;
  item.target = vec4(target.x, target.y, target.z, 0.0f);
  item.a = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  item.b = item.a;
  item.c = item.a;
  item.number = uvec4(slUint(number), slUint(number >> 32), mask, 0u);
  return item;
}

/// The same with the occluder a b c.
SL_FUNC ReverseItem occludedItem(ReverseItem item, vec3 a, vec3 b, vec3 c) {
  item.a = vec4(a.x, a.y, a.z, 0.0f);
  item.b = vec4(b.x, b.y, b.z, 0.0f);
  item.c = vec4(c.x, c.y, c.z, 0.0f);
  item.number.w = 1u;
  return item;
}

SL_FUNC uint64 reverseItemNumber(ReverseItem item) {
  return (slUint64(item.number.y) << 32) | slUint64(item.number.x);
}

/// The face for reverse ray k of the item: those that look at the target take turns. At least one must.
SL_FUNC uint reverseFace(ReverseItem item, uint k) {
  uint mask = item.number.z;
  uint count = 0u;
  for (uint face = 0u; face < 6u; ++face) count += (mask >> face) & 1u;
  uint skip = (k + item.number.x) % count;
  uint found = 0u;
  for (uint face = 0u; face < 6u; ++face) {
    bool looks = ((mask >> face) & 1u) != 0u;
    if (looks && skip == 0u) found = face;
    if (looks) skip -= 1u;  // wraps past the chosen one: never 0 again for six faces
  }
  return found;
}

/// Whether the segment of the ray, from its origin to t = 1, meets the item's occluder.
SL_FUNC bool segmentMeetsOccluder(Ray ray, ReverseItem item) {
  if (item.number.w == 0u || !hasDirection(ray)) return false;
  float t = intersectTriangle(shearRay(ray), xyz3(item.a), xyz3(item.b), xyz3(item.c));
  return t > 0.0f && t < 1.0f;
}

/// Reverse ray k of the item, from `face` = reverseFace(item, k); without direction where its start point
/// sees nothing but the occluder, or the cell does not look. The item's mask of faces must not be 0.
SL_FUNC Ray reverseRay(ReverseItem item, Face face, uint k, StageParams params) {
  vec3 origin = reverseOrigin(face, reverseItemNumber(item), k, params);
  Ray ray = whereCellLooks(rayTo(origin, xyz3(item.target)), params);
  if (segmentMeetsOccluder(ray, item)) ray.direction = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  return ray;
}

SL_NAMESPACE_END
#endif
