#version 460
// Bits to lists, in ascending order whatever the scheduling: counts the bits of each block of words; then
// sum_blocks, write_indices.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint block) {
  uint count = 0u;
  uint end = min((block + 1u) * kBlockWords, SL_LAUNCH.word_count);
  for (uint i = block * kBlockWords; i < end; ++i) count += uint(bitCount(Words(SL_LAUNCH.words).at[i]));
  Words(SL_LAUNCH.block_counts).at[block] = count;
}
