#version 460
// Nearest hits of given rays.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint index) {
  writeHit(index, nearestTriangle(SL_BUFFER(rays, index)));
}
