#version 460
// Counts the border rays of each entry of the border batch, and of each block; then sum_blocks, sum_border_rays.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  countBorderRaysOf(kTheStage, item);
}
