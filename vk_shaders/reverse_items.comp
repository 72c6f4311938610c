#version 460
// The discontinuities from reverse_first on, with all that their rays share.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"

void runItem(uint item) {
  ReverseItems(SL_LAUNCH.reverse_items).at[item] = reverseItemAt(SL_LAUNCH.reverse_first + item);
}
