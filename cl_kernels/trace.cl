// Nearest hits of SL_PACKET rays a work item, and the kernels that do nothing else.
#include "cl_kernels/random_packet.cl"
#include "cl_kernels/trace_packet.cl"
#include "cl_kernels/trace_single.cl"

#if SL_PACKET == 1
static uint traceRays(SceneRef scene, const Ray* rays, Hit* hits) {
  bool glass = false;
  hits[0] = traceRay(scene, rays[0], &glass);
  return glass ? 1u : 0u;
}
#endif

/// Hits of any rays; a work item takes the rays SL_PACKET * i ...
__kernel void traceRaysKernel(SL_SCENE_ARGS, __global const Ray* input_rays, __global Hit* output_hits,
                              uint count) {
  uint first = (uint)get_global_id(0) * SL_PACKET;
  Ray rays[SL_PACKET];
  Hit hits[SL_PACKET];
  for (uint i = 0; i < SL_PACKET; ++i) {
    rays[i].direction = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    rays[i].origin = rays[i].direction;
    if (first + i < count) rays[i] = input_rays[first + i];
  }
  traceRays(SL_SCENE_PACK, rays, hits);
  for (uint i = 0; i < SL_PACKET; ++i) {
    if (first + i < count) output_hits[first + i] = hits[i];
  }
}

/// Hits of a segment's random rays, slot by slot (a miss where a slot has none): for benchmarks and tests.
__kernel void traceSegmentKernel(SL_SCENE_ARGS, RandomSegment segment, Face face, uint4 shifts,
                                 __global Hit* output_hits) {
  Hit hits[SL_PACKET];
  uint offsets[SL_PACKET];
  uint first = (uint)get_global_id(0) * SL_PACKET;
  traceSlots(SL_SCENE_PACK, segment, face, shifts, first, offsets, hits);
  for (uint i = 0; i < SL_PACKET; ++i) {
    if (first + i < segment.batch.y * segment.batch.z) output_hits[first + i] = hits[i];
  }
}
