// Reverse sampling: rays from all over the view cell to the place of a discontinuity, past its occluder
// (thesis 5.3.2, algorithm 6.3).
//
// Differences from the thesis: a point is excluded only if the segment from it to the target really meets the
// occluder (the thesis projects the occluder onto the cell's plane, which fails where the target lies between
// the two); samples of a box are dealt out over all faces that look at the target; sample points differ from
// one discontinuity to the next.
#ifndef SL_REVERSE_H
#define SL_REVERSE_H
#include "core/shared/random_ray.h"
#include "core/shared/triangle.h"
SL_NAMESPACE_BEGIN

/// Rays for one discontinuity: 4 n_RSEdge + n_RSArea.
SL_FUNC uint reverseRayCount(StageParams params) {
  return 4u * params.counts.y + params.counts.z;
}

SL_FUNC bool faceLooksAt(Face face, vec3 target) {
  return dot3(sub3(target, xyz3(face.corner)), xyz3(face.normal)) > 0.0f;
}

/// The face for ray k of discontinuity `item`: the faces whose bit is set in mask (not 0) take turns.
SL_FUNC uint reverseFace(uint mask, uint item, uint k) {
  uint count = 0u;
  for (uint face = 0u; face < 6u; ++face) count += (mask >> face) & 1u;
  uint skip = (k + item) % count;
  uint found = 0u;
  for (uint face = 0u; face < 6u; ++face) {
    bool set = ((mask >> face) & 1u) != 0u;
    if (set && skip == 0u) found = face;
    if (set) skip -= 1u;  // wraps past the chosen one: never 0 again for six faces
  }
  return found;
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
    float along = (slFloat(place) + jitter) / slFloat(n_edge);
    u = edge == 0u ? along : (edge == 1u ? 1.0f : (edge == 2u ? 1.0f - along : 0.0f));
    v = edge == 0u ? 0.0f : (edge == 1u ? along : (edge == 2u ? 1.0f : 1.0f - along));
  } else {
    uint64 index = item * params.counts.z + slUint64(k - 4u * n_edge);
    u = haltonFraction(halton2(index, params.shifts.x));
    v = haltonFraction(halton3(index, params.shifts.y));
  }
  return add3(add3(xyz3(face.corner), scale3(xyz3(face.edge_u), u)), scale3(xyz3(face.edge_v), v));
}

/// The ray from origin to target (t = 1 there).
SL_FUNC Ray reverseRay(vec3 origin, vec3 target) {
  vec3 direction = sub3(target, origin);
  Ray ray;
  ray.origin = vec4(origin.x, origin.y, origin.z, 0.0f);
  ray.direction = vec4(direction.x, direction.y, direction.z, 0.0f);
  return ray;
}

/// Whether the segment of a reverse ray, from its origin to its target, meets the occluder.
SL_FUNC bool segmentMeetsTriangle(Ray ray, vec3 v0, vec3 v1, vec3 v2) {
  if (maxAbs3(xyz3(ray.direction)) == 0.0f) return false;
  float t = intersectTriangle(shearRay(ray), v0, v1, v2);
  return t > 0.0f && t < 1.0f;
}

SL_NAMESPACE_END
#endif
