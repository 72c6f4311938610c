#version 460
// The box around each chunk of kChunkTriangles leaves, six floats: lowest and highest corner.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint chunk) {
  uint first = chunk * kChunkTriangles;
  uint end = min(first + kChunkTriangles, SL_THE_LAUNCH.triangle_count);
  vec3 low = leafCorner(first, 0u);
  vec3 high = low;
  for (uint leaf = first; leaf < end; ++leaf) {
    for (uint corner = 0u; corner < 3u; ++corner) {
      vec3 point = leafCorner(leaf, corner);
      low = min(low, point);
      high = max(high, point);
    }
  }
  Buffer_uint bounds = Buffer_uint(SL_THE_LAUNCH.chunk_bounds);
  for (uint axis = 0u; axis < 3u; ++axis) {
    bounds.at[kBoxFloats * chunk + axis] = floatBitsToUint(low[axis]);
    bounds.at[kBoxFloats * chunk + 3u + axis] = floatBitsToUint(high[axis]);
  }
}
