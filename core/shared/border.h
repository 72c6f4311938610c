// Adaptive border sampling: rays to the border polygon of a triangle (thesis 5.3.1, equations 5.4 and 5.5,
// algorithm 6.2).
//
// The polygon has nine vertices, three about each corner, at a distance epsilon from the corner and at right
// angles to the ray that reaches it, so that they lie beside the triangle as the ray's origin sees it:
//
//                    x_22
//               x_21 /\ x_20        x_i,i   on the bisector of the corner, outside
//                   /p2\            x_i,i+1 beside the edge to the next corner
//                  /    \           x_i,i-1 beside the edge from the previous corner
//            x_02 /      \ x_12
//           x_00 /p0____p1\ x_11    long edges: x_i,i+1 to x_i+1,i, each with n_ABSEdge samples
//               x_01     x_10
//
// Differences from the thesis: "outside" is decided by the third corner (equation 5.4 presumes an
// orientation), and the bisector of a sharp corner comes from the edges' own directions, where the sum of the
// normals cancels.
#ifndef SL_BORDER_H
#define SL_BORDER_H
#include "core/shared/stage_params.h"
#include "core/shared/vector.h"
SL_NAMESPACE_BEGIN

/// Rays to one border polygon: 3 n_ABSEdge + 9.
SL_FUNC uint borderRayCount(StageParams params) {
  return 3u * params.counts.x + 9u;
}

/// Border distance at corner p for a ray from origin. The relative part grows with the distance and never
/// falls below eight float steps of the coordinates, where it would drown in rounding.
SL_FUNC float borderDistance(vec3 p, vec3 origin, StageParams params) {
  float relative = params.distances.x;
  float spacing = relative > 0.0f ? max(maxAbs3(p), maxAbs3(origin)) * 9.5367431640625e-7f : 0.0f;  // 2^-20
  return max(relative * length3(sub3(p, origin)), spacing) + params.distances.y;
}

/// Some unit vector at right angles to the unit vector r.
SL_FUNC vec3 anyPerpendicular(vec3 r) {
  float x = fabs(r.x);
  float y = fabs(r.y);
  float z = fabs(r.z);
  vec3 axis = (x <= y && x <= z) ? vec3(1.0f, 0.0f, 0.0f)
                                 : (y <= z ? vec3(0.0f, 1.0f, 0.0f) : vec3(0.0f, 0.0f, 1.0f));
  return normalize3(cross3(r, axis));
}

/// Unit vector at right angles to the unit vector r and to the edge, away from the triangle's third corner
/// (to_third: from the edge to it). An edge along the ray has no such side: any will do.
SL_FUNC vec3 outwardNormal(vec3 r, vec3 edge, vec3 to_third) {
  vec3 normal = normalize3(cross3(r, normalize3(edge)));
  if (dot3(normal, normal) == 0.0f) return anyPerpendicular(r);
  float side = dot3(normal, to_third);
  return side > 0.0f ? scale3(normal, -1.0f) : normal;
}

/// Unit vector of the bisector outside a corner. to_next, to_previous: the corner's edges; normal_next and
/// normal_previous: their outward normals.
SL_FUNC vec3 outwardBisector(vec3 r, vec3 to_next, vec3 to_previous, vec3 normal_next, vec3 normal_previous) {
  if (dot3(normal_next, normal_previous) > 0.0f) return normalize3(add3(normal_next, normal_previous));
  // Sharp corner: against the sum of the edges' directions as seen along the ray.
  vec3 along_next = cross3(r, normal_next);
  vec3 along_previous = cross3(r, normal_previous);
  along_next = dot3(along_next, to_next) < 0.0f ? scale3(along_next, -1.0f) : along_next;
  along_previous = dot3(along_previous, to_previous) < 0.0f ? scale3(along_previous, -1.0f) : along_previous;
  vec3 outward = scale3(add3(along_next, along_previous), -1.0f);
  // Seen edge on, both edges may run against each other: then their normals agree up to sign.
  return dot3(outward, outward) > 0.0f ? normalize3(outward) : normal_next;
}

/// The vertex beside corner p: which = 0 on the bisector, 1 beside the edge to `next`, 2 beside the edge to
/// `previous`.
SL_FUNC vec3 borderVertex(vec3 p, vec3 next, vec3 previous, uint which, vec3 origin, StageParams params) {
  vec3 r = normalize3(sub3(p, origin));
  vec3 to_next = sub3(next, p);
  vec3 to_previous = sub3(previous, p);
  vec3 normal_next = outwardNormal(r, to_next, to_previous);
  vec3 normal_previous = outwardNormal(r, to_previous, to_next);
  vec3 direction = normal_next;
  if (which == 0u) direction = outwardBisector(r, to_next, to_previous, normal_next, normal_previous);
  if (which == 2u) direction = normal_previous;
  return add3(p, scale3(direction, borderDistance(p, origin, params)));
}

/// Point k (0 .. borderRayCount - 1) of the border polygon of triangle p0 p1 p2 seen from origin.
SL_FUNC vec3 borderPoint(vec3 p0, vec3 p1, vec3 p2, uint k, vec3 origin, StageParams params) {
  uint per_edge = params.counts.x + 3u;
  uint edge = k / per_edge;
  uint place = k - edge * per_edge;  // 0: bisector, 1: first end, 2 .. n+1: between, n+2: second end
  vec3 a = edge == 0u ? p0 : (edge == 1u ? p1 : p2);
  vec3 b = edge == 0u ? p1 : (edge == 1u ? p2 : p0);
  vec3 c = edge == 0u ? p2 : (edge == 1u ? p0 : p1);
  if (place < 2u) return borderVertex(a, b, c, place, origin, params);
  vec3 end = borderVertex(b, c, a, 2u, origin, params);
  if (place == params.counts.x + 2u) return end;
  vec3 start = borderVertex(a, b, c, 1u, origin, params);
  float t = slFloat(place - 1u) / slFloat(params.counts.x + 1u);
  return add3(scale3(start, 1.0f - t), scale3(end, t));
}

/// Ray k to the border polygon: t = 1 at the border point (x_target).
SL_FUNC Ray borderRay(vec3 p0, vec3 p1, vec3 p2, uint k, vec3 origin, StageParams params) {
  vec3 direction = sub3(borderPoint(p0, p1, p2, k, origin, params), origin);
  Ray ray;
  ray.origin = vec4(origin.x, origin.y, origin.z, 0.0f);
  ray.direction = vec4(direction.x, direction.y, direction.z, 0.0f);
  return ray;
}

/// Whether a border ray meets a discontinuity (equation 5.7): it hits nothing, or something nearer than its
/// target by more than delta_RS.
SL_FUNC bool isDiscontinuity(Ray ray, Hit hit, StageParams params) {
  if (hit.triangle == kNoTriangle) return maxAbs3(xyz3(ray.direction)) > 0.0f;
  float distance = length3(xyz3(ray.direction));
  return (1.0f - hit.t) * distance > params.distances.z * distance + params.distances.w;
}

SL_NAMESPACE_END
#endif
