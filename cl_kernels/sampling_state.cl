// What the sampling stages read besides the scene: set, list of entries, faces; and the rays of a batch by index.
#ifndef SL_SAMPLING_STATE_CL
#define SL_SAMPLING_STATE_CL
#include "cl_kernels/trace.cl"
#include "core/shared/border.h"
#include "core/shared/random_ray.h"
#include "core/shared/reverse.h"
#include "core/shared/set.h"

#define SL_SET_ARGS                                                                       \
  volatile __global uint *keys, volatile __global uint *winner, volatile __global uint *fresh, \
      volatile __global uint *overflow, uint capacity
#define SL_SET_PACK \
  (SetRef) { keys, winner, fresh, overflow, capacity }

/// Where each triangle's corners are: id -> index of one of its records in scene.triangles.
#define SL_CORNER_ARGS __global const uint *record_of

typedef struct Corners {
  float3 a, b, c;
} Corners;

static inline Corners triangleCorners(SceneRef scene, __global const uint* record_of, uint triangle) {
  const TriangleRecord record = scene.triangles[record_of[triangle]];
  Corners corners;
#if SL_PACKET > 1
  corners.a = (float3)(record.vertices[0], record.vertices[1], record.vertices[2]);
  corners.b = (float3)(record.vertices[3], record.vertices[4], record.vertices[5]);
  corners.c = (float3)(record.vertices[6], record.vertices[7], record.vertices[8]);
#else
  corners.a = record.v0.xyz;
  corners.b = record.v1.xyz;
  corners.c = record.v2.xyz;
#endif
  return corners;
}

/// Counters are spread over this many words, by work-group, so that they do not fight for one.
#define SL_COUNTERS 256

static inline void countRays(volatile __global uint* counters, uint rays) {
  if (rays > 0) atomic_add(&counters[get_group_id(0) % SL_COUNTERS], rays);
}

static inline Ray noRay() {
  Ray ray;
  ray.origin = (float4)(0);
  ray.direction = (float4)(0);
  return ray;
}

static inline bool hasDirection(Ray ray) {
  return ray.direction.x != 0 || ray.direction.y != 0 || ray.direction.z != 0;
}

/// Where border rays come from: entries first .. of the list, borderRayCount rays each.
typedef struct BorderSource {
  __global const uint* record_of;
  __global const PvsEntry* entries;
  uint first;
} BorderSource;

/// Border ray `index` (0 ..) of the source.
static inline Ray borderRayAt(SceneRef scene, BorderSource source, StageParams params, uint index) {
  const uint per_entry = borderRayCount(params);
  const uint place = index / per_entry;
  const uint4 entry = source.entries[source.first + place].origin_triangle;
  const Corners corners = triangleCorners(scene, source.record_of, entry.w);
  return borderRay(corners.a, corners.b, corners.c, index - place * per_entry, as_float4(entry).xyz, params);
}

/// Where reverse rays come from: discontinuities first .. of the last border launch.
typedef struct ReverseSource {
  BorderSource border;
  __global const uint* border_hits;      ///< a border ray: what it hit
  __global const uint* discontinuities;  ///< indices of border rays
  uint first;
  ulong items_before;                    ///< discontinuities of the cell before this border launch
} ReverseSource;

/// Reverse ray `index` (0 ..) of the source; none where its start point sees only the occluder.
static inline Ray reverseRayAt(SceneRef scene, ReverseSource source, __global const Face* faces, StageParams params,
                               uint index) {
  const uint per_item = reverseRayCount(params);
  const uint place = index / per_item;
  const uint item = source.first + place;
  const uint k = index - place * per_item;
  const uint border_index = source.discontinuities[item];
  const Ray border = borderRayAt(scene, source.border, params, border_index);
  const float3 target = add3(border.origin.xyz, border.direction.xyz);
  uint mask = 0;
  for (uint f = 0; f < params.counts.w; ++f) mask |= (faceLooksAt(faces[f], target) ? 1u : 0u) << f;
  if (mask == 0) return noRay();
  const ulong number = source.items_before + item;
  const Face face = faces[reverseFace(mask, item, k)];
  const Ray ray = reverseRay(reverseOrigin(face, number, k, params), target);
  const uint occluder = source.border_hits[border_index];
  if (occluder != kNoTriangle) {
    const Corners corners = triangleCorners(scene, source.border.record_of, occluder);
    if (segmentMeetsTriangle(ray, corners.a, corners.b, corners.c)) return noRay();
  }
  return ray;
}

#endif
