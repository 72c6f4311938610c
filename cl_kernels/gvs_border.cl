// Border rays of the original method, one level a launch (core/shared/gvs_border.h).
#include "cl_kernels/sampling_state.cl"

/// Slots 0 .. total - 1 of the level over the batch; traces those whose neighbours hit different triangles.
/// Notes as traceBorder does.
__kernel void traceGvsBorder(SL_SCENE_ARGS, SL_SET_ARGS, StageParams params, SL_BORDER_ARGS,
                             __global const uint* record_of, uint level, uint total,
                             __global uint* border_hits, volatile __global uint* discontinuity_bits,
                             volatile __global uint* ray_counters) {
  const SceneRef scene = SL_SCENE_PACK;
  const SetRef set = SL_SET_PACK;
  const BorderBatch batch = SL_BORDER_PACK;
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  const uint slots = gvsSlots(level);
  Ray rays[SL_PACKET];
  Hit hits[SL_PACKET];
  uint index[SL_PACKET];
  uint traced = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    rays[lane] = noRay();
    if (first + lane >= total) continue;
    const uint entry = (first + lane) / slots * kGvsPositions;
    const uint position = gvsPosition(level, (first + lane) % slots);
    index[lane] = entry + position;
    if (level > 0 && !gvsDivides(border_hits[entry + gvsBefore(level, position)],
                                 border_hits[entry + gvsAfter(level, position)])) {
      continue;
    }
    rays[lane] = borderRayAt(batch, params, entry / kGvsPositions, position);
    traced += hasDirection(rays[lane]) ? 1 : 0;
  }
  if (traced == 0) return;
  traceRays(scene, rays, hits);
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    if (!hasDirection(rays[lane])) continue;
    border_hits[index[lane]] = hits[lane].triangle;
    insertHit(set, hits[lane].triangle, index[lane] + 1);
    const uint entry = border_first + index[lane] / kGvsPositions;
    const Corners t = triangleCorners(scene, record_of, entries[entry].origin_triangle.w);
    if (isGvsDiscontinuity(rays[lane], hits[lane], t.a, t.b, t.c, params)) {
      atomic_or(&discontinuity_bits[index[lane] >> 5], 1u << (index[lane] & 31));
    }
  }
  countRays(ray_counters, traced);
}
