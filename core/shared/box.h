// Conservative test of a ray against an axis-aligned box: never loses a hit of triangle.h.
//
// Based on: Williams et al., An Efficient and Robust Ray-Box Intersection Algorithm, JGT 2005, and Ize,
// Robust BVH Ray Traversal, JCGT 2(2), 2013. Where we differ: instead of widening the far distance by a
// factor, the box is widened on all sides by a constant of the ray, folded into the addends of the slab
// distances: it costs nothing per box, and covers the triangle test's own error.
//
//   distance to a plane p:  (p - origin) / direction  =  p * inverse + addend,  addend = -origin * inverse
//
// Error analysis, with u, S of triangle.h. The point at t of an accepted triangle is within 25 u S of the
// triangle on every axis, and therefore of each box that contains the triangle (of one of the boxes that
// share it, with spatial splits). The slab distance errs by at most 4.1 u (|p| + |origin|) |inverse|:
// inverse, product, addend and sum round once each, whether contracted or not. Components of the direction
// below 2^-40 of the largest are replaced by that: it moves the point at t by less than 2^-40 S. In all 29.2
// u S; the box is widened by 64 u S = 2^-18 S, which leaves a factor of 2 and room for builders that round
// the clipped boxes of spatial splits to nearest.
//
// Finite rays with coordinates up to 2^40 in magnitude, and S / max |direction| between 2^-60 and 2^80, give
// no NaN: all products stay finite, and an empty box (low +inf, high -inf) gives near +inf, far -inf.
#ifndef SL_BOX_H
#define SL_BOX_H
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

/// Half of what a box grows by, relative to S.
SL_CONST float kBoxPadding = 3.8146973e-6f;  // 2^-18
/// Direction components below this share of the largest are set to it.
SL_CONST float kSmallestSlope = 9.0949470e-13f;  // 2^-40

/// What the box test needs of a ray, computed once a ray.
SL_STRUCT(BoxRay) {
  vec4 inverse;      ///< xyz: 1 / direction
  vec4 near_addend;  ///< xyz: -origin * inverse - padding * |inverse|
  vec4 far_addend;   ///< xyz: -origin * inverse + padding * |inverse|
};

/// Largest |coordinate| of a scene's bounds: the scene's part of S.
SL_FUNC float sceneReach(vec3 low, vec3 high) {
  float x = max(fabs(low.x), fabs(high.x));
  float y = max(fabs(low.y), fabs(high.y));
  float z = max(fabs(low.z), fabs(high.z));
  return max(x, max(y, z));
}

SL_FUNC float boundedSlope(float component, float smallest) {
  return fabs(component) < smallest ? (component < 0.0f ? -smallest : smallest) : component;
}

/// Boxes grow by the padding on each side. The direction must not be zero.
SL_FUNC BoxRay paddedBoxRay(Ray ray, vec3 padding) {
  vec4 o = ray.origin;
  vec4 d = ray.direction;
  float smallest = kSmallestSlope * max(fabs(d.x), max(fabs(d.y), fabs(d.z)));
  float x = slDivide(1.0f, boundedSlope(d.x, smallest));
  float y = slDivide(1.0f, boundedSlope(d.y, smallest));
  float z = slDivide(1.0f, boundedSlope(d.z, smallest));
  vec4 middle = vec4(-o.x * x, -o.y * y, -o.z * z, 0.0f);
  vec4 spread = vec4(padding.x * fabs(x), padding.y * fabs(y), padding.z * fabs(z), 0.0f);
  BoxRay result;
  result.inverse = vec4(x, y, z, 0.0f);
  result.near_addend = middle - spread;
  result.far_addend = middle + spread;
  return result;
}

/// The direction must not be zero.
SL_FUNC BoxRay boxRay(Ray ray, float scene_reach) {
  vec4 o = ray.origin;
  float padding = kBoxPadding * (max(fabs(o.x), max(fabs(o.y), fabs(o.z))) + scene_reach);
  return paddedBoxRay(ray, vec3(padding, padding, padding));
}

/// x: where the ray enters the box, at least 0; y: where it leaves. It meets the box if x <= y, and may then
/// have a hit with t <= best in it if x <= best.
SL_FUNC vec2 intersectBox(BoxRay ray, vec3 low, vec3 high) {
  bool back_x = ray.inverse.x < 0.0f;
  bool back_y = ray.inverse.y < 0.0f;
  bool back_z = ray.inverse.z < 0.0f;
  float near_x = (back_x ? high.x : low.x) * ray.inverse.x + ray.near_addend.x;
  float near_y = (back_y ? high.y : low.y) * ray.inverse.y + ray.near_addend.y;
  float near_z = (back_z ? high.z : low.z) * ray.inverse.z + ray.near_addend.z;
  float far_x = (back_x ? low.x : high.x) * ray.inverse.x + ray.far_addend.x;
  float far_y = (back_y ? low.y : high.y) * ray.inverse.y + ray.far_addend.y;
  float far_z = (back_z ? low.z : high.z) * ray.inverse.z + ray.far_addend.z;
  return vec2(max(max(near_x, near_y), max(near_z, 0.0f)), min(min(far_x, far_y), far_z));
}

SL_NAMESPACE_END
#endif
