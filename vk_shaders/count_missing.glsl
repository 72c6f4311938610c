#version 460
// As trace_random, but only counts the hits outside the set.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  RandomSegment segment = SL_LAUNCH.segment;
  uint offset = slotOffset(segment, slot);
  if (offset == kNoTriangle) return;
  Ray ray = offsetRay(segment, Faces(SL_LAUNCH.faces).at[segment.range.x], SL_LAUNCH.shifts, offset);
  uint triangle = triangleOf(nearestHit(ray));
  if (triangle != kNoTriangle && !isInSet(kTheSet, triangle)) {
    atomicAdd(Words(SL_LAUNCH.counters).at[kMissingCounter], 1u);
  }
  countRay(slot);
}
