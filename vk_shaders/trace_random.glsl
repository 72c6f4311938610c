#version 460
// Random rays of a segment, one a slot.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  RandomSegment segment = SL_LAUNCH.segment;
  uint offset = slotOffset(segment, slot);
  if (offset == kNoTriangle) return;
  Ray ray = offsetRay(segment, Faces(SL_LAUNCH.faces).at[segment.range.x], SL_LAUNCH.shifts, offset);
  insertHit(kTheSet, triangleOf(nearestHit(ray)), segment.batch.x + offset);
  countRay(slot);
}
