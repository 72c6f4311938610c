#version 460
// Makes of the counts of border rays, and the sums before each block, the sums before each entry and before the end.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "core/shared/border.h"

void runItem(uint block) {
  uint before = Words(SL_LAUNCH.block_counts).at[block];
  uint end = min((block + 1u) * kBorderBlock, SL_LAUNCH.border_count);
  for (uint i = block * kBorderBlock; i < end; ++i) {
    uint rays = Words(SL_LAUNCH.border_starts).at[i];
    Words(SL_LAUNCH.border_starts).at[i] = before;
    before += rays;
  }
  if (end == SL_LAUNCH.border_count) Words(SL_LAUNCH.border_starts).at[end] = before;
}
