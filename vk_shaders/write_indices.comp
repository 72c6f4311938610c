#version 460
// Writes the indices of the set bits and clears them.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint block) {
  Words words = Words(SL_LAUNCH.words);
  Words indices = Words(SL_LAUNCH.indices);
  uint place = Words(SL_LAUNCH.block_counts).at[block];
  uint end = min((block + 1u) * kBlockWords, SL_LAUNCH.word_count);
  for (uint i = block * kBlockWords; i < end; ++i) {
    for (uint bits = words.at[i]; bits != 0u; bits &= bits - 1u) {
      indices.at[place++] = i * 32u + uint(findLSB(bits));
    }
    words.at[i] = 0u;
  }
}
