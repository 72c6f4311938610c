#version 460
// Counts the bits of each block of words; then sum_blocks, write_indices.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  countBitsOf(kTheStage, item);
}
