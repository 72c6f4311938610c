#version 460
// Sums before each block of its counts, in place, by one work group; the total goes to the counters.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/sampling.glsl"
layout(local_size_x = SL_SUM_ITEMS) in;

shared uint partial[SL_SUM_ITEMS];

void main() {
  uint item = gl_LocalInvocationID.x;
  partial[item] = sumOfShare(kTheStage, item);
  barrier();
  uint before = 0u;
  for (uint i = 0u; i < item; ++i) before += partial[i];
  writeShare(kTheStage, item, before);
}
