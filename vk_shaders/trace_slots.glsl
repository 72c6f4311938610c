#version 460
// As trace_random, but writes each slot's hit and inserts nothing: for benchmarks.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  RandomSegment segment = SL_LAUNCH.segment;
  uint offset = slotOffset(segment, slot);
  if (offset == kNoTriangle) return;
  Ray ray = offsetRay(segment, Faces(SL_LAUNCH.faces).at[segment.range.x], SL_LAUNCH.shifts, offset);
  writeHit(slot, nearestHit(ray));
}
