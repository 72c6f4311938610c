#version 460
// Puts triangles into the set and the list without a ray.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  insertContainedOf(kTheStage, item);
}
