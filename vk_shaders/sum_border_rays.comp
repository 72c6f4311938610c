#version 460
// Makes of the counts of border rays, and the sums before each block, the sums before each entry and before the end.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  sumBorderRaysOf(kTheStage, item);
}
