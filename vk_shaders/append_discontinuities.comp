#version 460
// Appends the discontinuities of the border rays in `indices` to those that wait.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"

void runItem(uint item) {
  uint index = Words(SL_LAUNCH.indices).at[item];
  uint entry_index = borderEntryOf(index);
  Discontinuity discontinuity;
  discontinuity.ray = uvec4(SL_LAUNCH.border_first + entry_index, borderRayOf(index, entry_index),
                            Words(SL_LAUNCH.border_hits).at[index], borderSamplesAt(entry_index));
  Discontinuities(SL_LAUNCH.discontinuities).at[SL_LAUNCH.waiting + item] = discontinuity;
}
