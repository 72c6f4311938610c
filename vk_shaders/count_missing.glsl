#version 460
// As trace_random, but only counts the rays that see something outside the set.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  uint offset;
  Ray ray;
  if (!slotRayAt(slot, offset, ray)) return;
  Hit hit = nearestTriangle(ray);
  bool lacks = hit.triangle != kNoTriangle && !isInSet(kTheSet, hit.triangle);
#if SL_HAS_GLASS
  if (!lacks && met_glass) lacks = walkGlass(kTestGlass, 0u, ray, hit);
#endif
  if (lacks) {
    SL_STAGE_ADD(counters, kMissingCounter, 1u);
  }
  countRay(slot);
}
