#version 460
// As trace_random, but only counts the hits outside the set.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  uint offset;
  Ray ray;
  if (!slotRayAt(slot, offset, ray)) return;
  uint triangle = triangleOf(nearestHit(ray));
  if (triangle != kNoTriangle && !isInSet(kTheSet, triangle)) {
    SL_STAGE_ADD(counters, kMissingCounter, 1u);
  }
  countRay(slot);
}
