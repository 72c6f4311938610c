#version 460
// Exclusive sums of the block counts in place, by one work group; the total goes to the counters.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/state.glsl"
layout(local_size_x = 64) in;  // kSumItems

shared uint partial[kSumItems];

void main() {
  uint block_count = SL_LAUNCH.block_count;
  Words blocks = Words(SL_LAUNCH.block_counts);
  uint thread = gl_LocalInvocationID.x;
  uint share = (block_count + kSumItems - 1u) / kSumItems;
  uint begin = min(thread * share, block_count);
  uint end = min(begin + share, block_count);
  uint sum = 0u;
  for (uint i = begin; i < end; ++i) sum += blocks.at[i];
  partial[thread] = sum;
  barrier();
  uint running = 0u;
  for (uint i = 0u; i < thread; ++i) running += partial[i];
  for (uint i = begin; i < end; ++i) {
    uint count = blocks.at[i];
    blocks.at[i] = running;
    running += count;
  }
  if (thread == kSumItems - 1u) Words(SL_LAUNCH.counters).at[SL_LAUNCH.sum_place] = running;
}
