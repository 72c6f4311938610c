#version 460
// Counts the border rays of each entry of the border batch, and of each block of kBorderBlock; then sum_blocks,
// sum_border_rays.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"

void runItem(uint block) {
  StageParams params = SL_LAUNCH.params;
  uint end = min((block + 1u) * kBorderBlock, SL_LAUNCH.border_count);
  uint rays = 0u;
  for (uint i = block * kBorderBlock; i < end; ++i) {
    uvec4 entry = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + i].origin_triangle;
    uint leaf = Words(SL_LAUNCH.leaf_of).at[entry.w];
    uint samples = borderSamples(leafCorner(leaf, 0u), leafCorner(leaf, 1u), leafCorner(leaf, 2u),
                                 borderOrigin(entry), params);
    uint count = borderRayCount(samples, params);
    Words(SL_LAUNCH.border_starts).at[i] = count;
    rays += count;
  }
  Words(SL_LAUNCH.block_counts).at[block] = rays;
}
