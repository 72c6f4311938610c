#version 460
// As trace_random, but writes each slot's hit and inserts nothing: for benchmarks.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  uint offset;
  Ray ray;
  if (!slotRayAt(slot, offset, ray)) return;
  writeHit(slot, nearestTriangle(ray));
}
