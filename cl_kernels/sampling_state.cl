// What the sampling stages read besides the scene: set, list of entries, faces; and the rays of a batch by
// index.
#ifndef SL_SAMPLING_STATE_CL
#define SL_SAMPLING_STATE_CL
#include "cl_kernels/trace.cl"
#include "core/shared/border.h"
#include "core/shared/gvs_reverse.h"
#include "core/shared/random_ray.h"
#include "core/shared/reverse.h"
#include "core/shared/set.h"

#define SL_SET_ARGS                                                                            \
  volatile __global uint *keys, volatile __global uint *winner, volatile __global uint *fresh, \
      volatile __global uint *overflow, uint capacity
#define SL_SET_PACK                         \
  (SetRef) {                                \
    keys, winner, fresh, overflow, capacity \
  }

/// Where each triangle's corners are: id -> index of one of its records in scene.triangles.
#define SL_CORNER_ARGS __global const uint* record_of

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

/// Where border rays come from: entries first .. of the list, borderRayCount rays each.
typedef struct BorderSource {
  __global const uint* record_of;
  __global const PvsEntry* entries;
  uint first;
} BorderSource;

/// A walk over border rays: rays one after the other share the side of a border polygon.
typedef struct BorderWalk {
  uint place;  ///< entry * 3 + side; kNoTriangle before the first ray
  float3 origin;
  BorderEdge edge;
} BorderWalk;

static inline BorderWalk startBorderWalk() {
  BorderWalk walk;
  walk.place = kNoTriangle;
  return walk;
}

/// Border ray `index` (0 ..) of the source; moves the walk there.
static inline Ray walkToBorderRay(BorderWalk* walk, SceneRef scene, BorderSource source, StageParams params,
                                  uint index) {
  const uint per_entry = borderRayCount(params);
  const uint entry_index = index / per_entry;
  const uint k = index - entry_index * per_entry;
  const uint side = borderSide(k, params);
  if (entry_index * 3 + side != walk->place) {
    const uint4 entry = source.entries[source.first + entry_index].origin_triangle;
    const Corners corners = triangleCorners(scene, source.record_of, entry.w);
    walk->place = entry_index * 3 + side;
    walk->origin = as_float4(entry).xyz;
    walk->edge = borderEdge(corners.a, corners.b, corners.c, side, walk->origin, params);
  }
  return borderRay(walk->edge, k, walk->origin, params);
}

/// The same of the original method: `index` is a position of an entry's polygon.
static inline Ray gvsRayAt(SceneRef scene, BorderSource source, StageParams params, uint index) {
  const uint entry_index = index / kGvsPositions;
  const uint position = index - entry_index * kGvsPositions;
  const uint4 entry = source.entries[source.first + entry_index].origin_triangle;
  const Corners t = triangleCorners(scene, source.record_of, entry.w);
  const float3 origin = as_float4(entry).xyz;
  const float3 from = gvsVertex(t.a, t.b, t.c, gvsFirstVertex(position), origin, params);
  if (position % 8 == 0) return rayTo(origin, from);
  const float3 to = gvsVertex(t.a, t.b, t.c, gvsSecondVertex(position), origin, params);
  return rayTo(origin, gvsPoint(from, to, position));
}

/// Border ray `index` (0 ..) of the source, by the method of the parameters.
static inline Ray borderRayAt(SceneRef scene, BorderSource source, StageParams params, uint index) {
  if (isGvs(params)) return gvsRayAt(scene, source, params, index);
  BorderWalk walk = startBorderWalk();
  return walkToBorderRay(&walk, scene, source, params, index);
}

/// Where reverse rays come from: discontinuities first .. of the last border launch.
typedef struct ReverseSource {
  BorderSource border;
  __global const uint* border_hits;      ///< a border ray: what it hit
  __global const uint* discontinuities;  ///< indices of border rays
  uint first;
  ulong items_before;  ///< discontinuities of the cell before this border launch
} ReverseSource;

/// Discontinuity `place` (0 ..) of the source.
static inline ReverseItem reverseItemAt(SceneRef scene, ReverseSource source, __global const Face* faces,
                                        StageParams params, uint place) {
  const uint border_index = source.discontinuities[source.first + place];
  const Ray border = borderRayAt(scene, source.border, params, border_index);
  const float3 target = add3(border.origin.xyz, border.direction.xyz);
  const ulong number = source.items_before + source.first + place;
  uint mask = 0;
  for (uint f = 0; f < params.counts.w; ++f) mask |= (faceLooksAt(faces[f], target) ? 1u : 0u) << f;
  ReverseItem item;
  item.target = (float4)(target, 0);
  const uint occluder = source.border_hits[border_index];
  item.number = (uint4)((uint)number, (uint)(number >> 32), mask, occluder != kNoTriangle);
  item.a = item.b = item.c = (float4)(0);
  if (occluder != kNoTriangle) {
    const Corners corners = triangleCorners(scene, source.border.record_of, occluder);
    item.a.xyz = corners.a;
    item.b.xyz = corners.b;
    item.c.xyz = corners.c;
  }
  if (isGvs(params)) {
    const PvsEntry entry = source.border.entries[source.border.first + border_index / kGvsPositions];
    const Corners t = triangleCorners(scene, source.border.record_of, entry.origin_triangle.w);
    Ray found;
    found.origin = (float4)(as_float4(entry.origin_triangle).xyz, 0);
    found.direction = (float4)(as_float4(entry.direction_stage).xyz, 0);
    item = gvsReverseItem(item, found, t.a, t.b, t.c, params);
  }
  return item;
}

/// A walk over reverse rays: rays one after the other share a discontinuity.
typedef struct ReverseWalk {
  uint place;  ///< kNoTriangle before the first ray
  ReverseItem item;
} ReverseWalk;

static inline ReverseWalk startReverseWalk() {
  ReverseWalk walk;
  walk.place = kNoTriangle;
  return walk;
}

/// Reverse ray `index` (0 ..) of the source, or none; moves the walk there.
static inline Ray walkToReverseRay(ReverseWalk* walk, SceneRef scene, ReverseSource source,
                                   __global const Face* faces, StageParams params, uint index) {
  const uint per_item = reverseRayCount(params);
  const uint place = index / per_item;
  const uint k = index - place * per_item;
  if (place != walk->place) {
    walk->place = place;
    walk->item = reverseItemAt(scene, source, faces, params, place);
  }
  if (walk->item.number.z == 0) return noRay();
  if (isGvs(params)) {
    Ray ray = noRay();
    for (uint f = 0; f < params.counts.w && !hasDirection(ray); ++f) {
      ray = gvsReverseRay(walk->item, faces[f], k);
    }
    return ray;
  }
  return reverseRay(walk->item, faces[reverseFace(walk->item, k)], k, params);
}

#endif
