#version 460
// Reverse rays of the discontinuities from reverse_first on.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint index) {
  Ray ray = reverseRayAt(kTheStage, index);
  if (!hasDirection(ray)) return;
  insertSight(ray, index + 1u);
  countRay(index);
}
