// The sampling stages: generate SL_PACKET rays a work item, trace them together, insert what they hit.
#include "cl_kernels/sampling_state.cl"

__kernel void traceRandom(SL_SCENE_ARGS, SL_SET_ARGS, __global const Face* faces, StageParams params,
                          RandomSegment segment, volatile __global uint* ray_counters) {
  const SceneRef scene = SL_SCENE_PACK;
  const SetRef set = SL_SET_PACK;
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  const Face face = faces[segment.range.x];
  Hit hits[SL_PACKET];
  uint offsets[SL_PACKET];
  traceSlots(scene, segment, face, params.shifts, first, offsets, hits);
  uint traced = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    insertHit(set, hits[lane].triangle, segment.batch.x + offsets[lane]);
    traced += offsets[lane] != kNoTriangle ? 1 : 0;
  }
  countRays(ray_counters, traced);
}

/// As traceRandom, but only counts the hits outside the set.
__kernel void countMissing(SL_SCENE_ARGS, SL_SET_ARGS, __global const Face* faces, uint4 shifts,
                           RandomSegment segment, volatile __global uint* ray_counters) {
  const SceneRef scene = SL_SCENE_PACK;
  const SetRef set = SL_SET_PACK;
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  const Face face = faces[segment.range.x];
  Hit hits[SL_PACKET];
  uint offsets[SL_PACKET];
  traceSlots(scene, segment, face, shifts, first, offsets, hits);
  uint traced = 0;
  uint missing = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    const uint triangle = hits[lane].triangle;
    traced += offsets[lane] != kNoTriangle ? 1 : 0;
    missing += triangle != kNoTriangle && !isInSet(set, triangle) ? 1 : 0;
  }
  if (missing > 0) atomic_add(&ray_counters[SL_MISSING_COUNTER], missing);
  countRays(ray_counters, traced);
}

/// All border rays of the batch; notes what each hit and, a bit a ray, whether it met a discontinuity. Those
/// without direction hit nothing and are not counted.
__kernel void traceBorder(SL_SCENE_ARGS, SL_SET_ARGS, StageParams params, SL_BORDER_ARGS,
                          __global uint* border_hits, volatile __global uint* discontinuity_bits,
                          volatile __global uint* ray_counters) {
  const SceneRef scene = SL_SCENE_PACK;
  const SetRef set = SL_SET_PACK;
  const BorderBatch batch = SL_BORDER_PACK;
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  const uint total = starts[border_count];
  const uint count = min((uint)SL_PACKET, total - min(first, total));
  if (count == 0) return;
  Ray rays[SL_PACKET];
  Hit hits[SL_PACKET];
  uint entry = borderEntryOf(batch, first);
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    if (lane < count) entry = nextBorderEntry(batch, entry, first + lane);
    rays[lane] = lane < count ? borderRayAt(batch, params, entry, first + lane - starts[entry]) : noRay();
  }
  traceRays(scene, rays, hits);
  uint bits = 0;
  uint traced = 0;
  for (uint lane = 0; lane < count; ++lane) {
    traced += hasDirection(rays[lane]) ? 1 : 0;
    border_hits[first + lane] = hits[lane].triangle;
    insertHit(set, hits[lane].triangle, first + lane + 1);
    bits |= (isDiscontinuity(rays[lane], hits[lane], params) ? 1u : 0u) << lane;
  }
  if (bits != 0) atomic_or(&discontinuity_bits[first >> 5], bits << (first & 31));
  countRays(ray_counters, traced);
}

/// Reverse rays 0 .. total - 1 of the items: one a lane.
__kernel void traceReverse(SL_SCENE_ARGS, SL_SET_ARGS, __global const Face* faces, StageParams params,
                           __global const ReverseItem* items, uint total,
                           volatile __global uint* ray_counters) {
  const SceneRef scene = SL_SCENE_PACK;
  const SetRef set = SL_SET_PACK;
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  Ray rays[SL_PACKET];
  Hit hits[SL_PACKET];
  uint traced = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    rays[lane] = first + lane < total ? reverseRayAt(items, faces, params, first + lane) : noRay();
    traced += hasDirection(rays[lane]) ? 1 : 0;
  }
  if (traced == 0) return;
  traceRays(scene, rays, hits);
  for (uint lane = 0; lane < SL_PACKET; ++lane) insertHit(set, hits[lane].triangle, first + lane + 1);
  countRays(ray_counters, traced);
}
