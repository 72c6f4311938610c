// Random rays of SL_PACKET neighbouring slots of a segment, on a CPU eight at a time on its vectors.
#include "cl_kernels/ray_packet.cl"
#include "cl_kernels/trace_packet.cl"
#include "cl_kernels/trace_single.cl"
#include "core/shared/random_ray.h"

#if SL_PACKET == 8

#define SL_UINTS uint8
#define SL_FLOATS float8
#define SL_LANES(name) name##8
#define SL_MUL_HIGH(a, b) convert_uint8((convert_ulong8(a) * (ulong)(b)) >> 32)
#define SL_TO_FLOATS(x) convert_float8(as_int8(x))
#include "core/shared/random_lanes.inl"

/// randomRay of the points first + offset; lanes whose offset is kNoTriangle get none.
static inline RayPacket randomPacket(uint64 first, uint8 offset, Face face, uint4 shifts) {
  RandomRays8 rays = randomRays8(first, offset, face, shifts);
  int8 none = offset == kNoTriangle;
  RayPacket packet;
  packet.origin[0] = rays.origin_x;
  packet.origin[1] = rays.origin_y;
  packet.origin[2] = rays.origin_z;
  packet.direction[0] = none ? (float8)0.0f : rays.direction_x;
  packet.direction[1] = none ? (float8)0.0f : rays.direction_y;
  packet.direction[2] = none ? (float8)0.0f : rays.direction_z;
  return packet;
}

#endif

/// slotOffset of the slots first .. first + SL_PACKET - 1; kNoTriangle past the last slot.
static inline void slotOffsets(RandomSegment segment, uint first, uint* offsets) {
  const uint slots = segment.batch.y * segment.batch.z;
  SlotWalk walk = startSlotWalk();
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    offsets[lane] = kNoTriangle;
    if (first + lane >= slots) continue;
    walk = walkToSlot(walk, segment, first + lane);
    offsets[lane] = walkOffset(walk, segment, first + lane);
  }
}

/// Generates and traces the rays of the slots first .. first + SL_PACKET - 1. offsets: of each ray in the
/// segment, or kNoTriangle where a slot has none (its hit is a miss). Returns as traceRays does.
static inline uint traceSlots(SceneRef scene, RandomSegment segment, Face face, uint4 shifts, uint first,
                              uint* offsets, Hit* hits) {
  slotOffsets(segment, first, offsets);
#if SL_PACKET == 8
  RayPacket rays = randomPacket(segmentFirst(segment), vload8(0, offsets), face, shifts);
  const HitPacket packet = traceLanes(scene, &rays);
  storeHits(packet, hits);
  return packet.glass;
#else
  hits[0] = missHit();
  if (offsets[0] == kNoTriangle) return 0u;
  bool glass = false;
  hits[0] = traceRay(scene, randomRay(segmentFirst(segment), offsets[0], face, shifts), &glass);
  return glass ? 1u : 0u;
#endif
}
