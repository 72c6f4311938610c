#version 460
// Random rays of a segment, one a slot.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  uint offset;
  Ray ray;
  if (!slotRayAt(slot, offset, ray)) return;
  insertSight(ray, SL_LAUNCH(segment).batch.x + offset);
  countRay(slot);
}
