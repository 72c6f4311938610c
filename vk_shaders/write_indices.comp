#version 460
// Writes the indices of the set bits and clears them.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  writeIndicesOf(kTheStage, item);
}
