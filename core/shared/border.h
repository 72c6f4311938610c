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
// normals cancels. The samples' number follows the triangle's apparent size: of a city's visible triangles 40
// % are below a tenth of a pixel, and their neighbours need no twenty samples an edge.
#ifndef SL_BORDER_H
#define SL_BORDER_H
#include "core/shared/look.h"
SL_NAMESPACE_BEGIN

/// Samples between the ends of a long edge at least, where the spacing decides.
SL_CONST uint kFewestBorderSamples = 2u;

/// Rays to a border polygon with so many samples between the ends of its long edges; of the original method
/// at most.
SL_FUNC uint borderRayCount(uint samples, StageParams params) {
  return isGvs(params) ? kGvsPositions : 3u * samples + 9u;
}

/// Samples between the ends of each long edge of the border polygon of triangle p0 p1 p2: as many as lie
/// spacing.x apart along the longest edge, on a unit sphere about origin; n_ABSEdge at most.
SL_FUNC uint borderSamples(vec3 p0, vec3 p1, vec3 p2, vec3 origin, StageParams params) {
  uint most = params.counts.x;
  if (params.spacing.x == 0.0f || most <= kFewestBorderSamples) return most;
  vec3 r0 = normalize3(sub3(p0, origin));
  vec3 r1 = normalize3(sub3(p1, origin));
  vec3 r2 = normalize3(sub3(p2, origin));
  float longest = max(max(length3(sub3(r1, r0)), length3(sub3(r2, r1))), length3(sub3(r0, r2)));
  float wanted = slDivide(longest, params.spacing.x);
  return wanted < slFloat(most) ? max(slUint(wanted), kFewestBorderSamples) : most;
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

/// One side of the border polygon: all that its samples have in common.
SL_STRUCT(BorderEdge) {
  vec4 bisector;  ///< vertex outside the edge's first corner; w: samples between the ends
  vec4 start;     ///< ends of the long edge
  vec4 end;
};

/// The side with its long edge cut off where a flat cell no longer looks; as it is where the cell looks at
/// both ends, or at none.
SL_FUNC BorderEdge cutToLook(BorderEdge edge, vec3 origin, StageParams params) {
  if (!looksOneWay(params)) return edge;
  vec3 start = sub3(xyz3(edge.start), origin);
  vec3 end = sub3(xyz3(edge.end), origin);
  float least = kCutSlope * max(maxAbs3(start), maxAbs3(end));
  float start_height = dot3(start, xyz3(params.look));
  float end_height = dot3(end, xyz3(params.look));
  if ((start_height >= least) == (end_height >= least)) return edge;
  float t = slDivide(least - start_height, end_height - start_height);
  vec4 cut = edge.start * (1.0f - t) + edge.end * t;
  if (start_height < least) {
    edge.start = cut;
  } else {
    edge.end = cut;
  }
  return edge;
}

/// Side 0, 1 or 2 of the border polygon of triangle p0 p1 p2 seen from origin.
SL_FUNC BorderEdge borderEdge(vec3 p0, vec3 p1, vec3 p2, uint side, vec3 origin, StageParams params) {
  vec3 a = side == 0u ? p0 : (side == 1u ? p1 : p2);
  vec3 b = side == 0u ? p1 : (side == 1u ? p2 : p0);
  vec3 c = side == 0u ? p2 : (side == 1u ? p0 : p1);
  vec3 bisector = borderVertex(a, b, c, 0u, origin, params);
  vec3 start = borderVertex(a, b, c, 1u, origin, params);
  vec3 end = borderVertex(b, c, a, 2u, origin, params);
  BorderEdge edge;
  float samples = slFloat(borderSamples(p0, p1, p2, origin, params));
  edge.bisector = vec4(bisector.x, bisector.y, bisector.z, samples);
  edge.start = vec4(start.x, start.y, start.z, 0.0f);
  edge.end = vec4(end.x, end.y, end.z, 0.0f);
  return cutToLook(edge, origin, params);
}

/// The side that point k (0 .. borderRayCount - 1) of a polygon lies on: it has its bisector vertex, both
/// ends and the samples between.
SL_FUNC uint borderSide(uint k, uint samples) {
  return k / (samples + 3u);
}

/// Place 0 .. samples + 2 of point k on its side.
SL_FUNC uint borderPlace(uint k, uint samples) {
  return k % (samples + 3u);
}

/// Point k of the polygon; edge: of its side.
SL_FUNC vec3 borderPoint(BorderEdge edge, uint k) {
  uint samples = slUint(edge.bisector.w);
  uint place = borderPlace(k, samples);
  if (place == 0u) return xyz3(edge.bisector);
  if (place == 1u) return xyz3(edge.start);
  if (place == samples + 2u) return xyz3(edge.end);
  float t = slDivide(slFloat(place - 1u), slFloat(samples + 1u));
  return add3(scale3(xyz3(edge.start), 1.0f - t), scale3(xyz3(edge.end), t));
}

/// The ray from origin to point k: t = 1 there (x_target). Without direction where the cell does not look.
SL_FUNC Ray borderRay(BorderEdge edge, uint k, vec3 origin, StageParams params) {
  return whereCellLooks(rayTo(origin, borderPoint(edge, k)), params);
}

/// Whether a border ray meets a discontinuity (equation 5.7): it hits nothing, or something nearer than its
/// target by more than delta_RS.
SL_FUNC bool isDiscontinuity(Ray ray, Hit hit, StageParams params) {
  if (hit.triangle == kNoTriangle) return hasDirection(ray);
  float distance = length3(xyz3(ray.direction));
  return (1.0f - hit.t) * distance > params.distances.z * distance + params.distances.w;
}

/// Whether a discontinuity gets reverse rays. place: on its side of the border polygon; follows: the sample
/// before it on this side met one by the same occluder, or nothing like this one. In a run of such samples
/// the first counts, and every sample whose place is a multiple of the stride; a stride of 1 keeps all.
SL_FUNC bool keepsDiscontinuity(uint place, bool follows, StageParams params) {
  return !follows || place % params.method.y == 0u;
}

/// Border rays are traced for whole blocks of entries, so that devices can cut batches alike.
SL_CONST uint kBorderBlock = 32u;

SL_NAMESPACE_END
#endif
