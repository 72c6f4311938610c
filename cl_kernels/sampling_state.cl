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
  const SceneTriangle record = scene.triangles[record_of[triangle]];
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

/// Words of the counters, which the host reads at once. Rays are spread over many, by work-group, so that
/// they do not fight for one. Word 0 is the set's overflow flag.
#define SL_RAY_COUNTER 1
#define SL_RAY_COUNTERS 256
#define SL_MISSING_COUNTER 257

static inline void countRays(volatile __global uint* counters, uint rays) {
  if (rays > 0) atomic_add(&counters[SL_RAY_COUNTER + get_group_id(0) % SL_RAY_COUNTERS], rays);
}

/// The batch of border rays: those of the entries from `first` on, borderRayCount each.
#define SL_BORDER_ARGS                                                                   \
  __global const PvsEntry *entries, uint border_first, __global const BorderEdge *edges, \
      __global const uint *starts, uint border_count
#define SL_BORDER_PACK                                 \
  (BorderBatch) {                                      \
    entries, border_first, edges, starts, border_count \
  }
typedef struct BorderBatch {
  __global const PvsEntry* entries;
  uint first;
  __global const BorderEdge* edges;  ///< three an entry, by borderEdges
  __global const uint* starts;       ///< border rays of the batch before each entry's, and all
  uint count;                        ///< entries
} BorderBatch;

/// The entry of the batch that border ray `index` belongs to.
static inline uint borderEntryOf(BorderBatch batch, uint index) {
  uint low = 0, high = batch.count;
  while (high - low > 1) {
    const uint middle = (low + high) / 2;
    if (batch.starts[middle] <= index) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

/// As borderEntryOf, from the entry of a ray shortly before.
static inline uint nextBorderEntry(BorderBatch batch, uint entry, uint index) {
  while (entry + 1 < batch.count && batch.starts[entry + 1] <= index) ++entry;
  return entry;
}

/// Ray k of the batch's entry.
static inline Ray borderRayAt(BorderBatch batch, StageParams params, uint entry, uint k) {
  const float3 origin = as_float4(batch.entries[batch.first + entry].origin_triangle).xyz;
  __global const BorderEdge* edges = &batch.edges[entry * 3];
  if (isGvs(params)) {
    const uint first = gvsFirstVertex(k), second = gvsSecondVertex(k);
    const float3 from = gvsVertexOf(edges[first / 3], first);
    return gvsBorderRay(from, gvsVertexOf(edges[second / 3], second), k, origin, params);
  }
  return borderRay(edges[borderSide(k, slUint(edges->bisector.w))], k, origin, params);
}

/// The item of a discontinuity. number: its running number in the cell.
static inline ReverseItem reverseItemOf(SceneRef scene, __global const uint* record_of,
                                        __global const PvsEntry* entries, __global const Face* faces,
                                        StageParams params, Discontinuity discontinuity, ulong number) {
  const uint4 ray = discontinuity.ray;
  const PvsEntry entry = entries[ray.x];
  const Corners t = triangleCorners(scene, record_of, entry.origin_triangle.w);
  const float3 origin = as_float4(entry.origin_triangle).xyz;
  const Ray border = polygonRay(t.a, t.b, t.c, ray.y, ray.w, origin, params);
  const float3 target = add3(border.origin.xyz, border.direction.xyz);
  uint mask = 0;
  for (uint f = 0; f < params.counts.w; ++f) mask |= (faceLooksAt(faces[f], target) ? 1u : 0u) << f;
  ReverseItem item = openItem(target, number, mask);
  if (ray.z != kNoTriangle) {
    const Corners corners = triangleCorners(scene, record_of, ray.z);
    item = occludedItem(item, corners.a, corners.b, corners.c);
  }
  if (isGvs(params)) {
    Ray found;
    found.origin = (float4)(as_float4(entry.origin_triangle).xyz, 0);
    found.direction = (float4)(as_float4(entry.direction_stage).xyz, 0);
    item = gvsReverseItem(item, found, t.a, t.b, t.c, params);
  }
  return item;
}

/// Reverse ray `index` (0 ..) of the items, or none.
static inline Ray reverseRayAt(__global const ReverseItem* items, __global const Face* faces,
                               StageParams params, uint index) {
  const uint per_item = reverseRayCount(params);
  const uint place = index / per_item;
  const uint k = index - place * per_item;
  const ReverseItem item = items[place];
  if (item.number.z == 0) return noRay();
  if (isGvs(params)) {
    Ray ray = noRay();
    for (uint f = 0; f < params.counts.w && !hasDirection(ray); ++f) {
      ray = gvsReverseRay(item, faces[f], k, params);
    }
    return ray;
  }
  return reverseRay(item, faces[reverseFace(item, k)], k, params);
}

#endif
