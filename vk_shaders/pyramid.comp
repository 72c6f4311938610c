#version 460
// Six levels of the pyramid (core/shared/pyramid.h) at once, from level z on: a group 64 by 64 texels of it.
//   launch: float[] of all levels; numbers: width, height, level; w: 1 to drop odd columns and rows, a fault for tests
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"
#include "core/shared/pyramid.h"

layout(local_size_x = 16, local_size_y = 16) in;
shared float tile[16][16];

const float kNothing = 2.0f;  // nearer than anything

uvec2 sizeOf(uint level) {
  return uvec2(levelSize(push.numbers.x, level), levelSize(push.numbers.y, level));
}

float texel(uint level, uvec2 at) {
  uvec2 size = sizeOf(level);
  if (push.numbers.w != 0u) size -= uvec2(size.x > 1u ? size.x & 1u : 0u, size.y > 1u ? size.y & 1u : 0u);
  if (at.x >= size.x || at.y >= size.y) return kNothing;
  return Floats(push.launch + 4ul * levelStart(push.numbers.x, push.numbers.y, level)).at[at.y * sizeOf(level).x + at.x];
}

void put(uint level, uvec2 at, float depth) {
  uvec2 size = sizeOf(level);
  if (level >= pyramidLevels(push.numbers.x, push.numbers.y) || at.x >= size.x || at.y >= size.y) return;
  Floats(push.launch + 4ul * levelStart(push.numbers.x, push.numbers.y, level)).at[at.y * size.x + at.x] = depth;
}

void main() {
  uint level = push.numbers.z;
  uvec2 lane = gl_LocalInvocationID.xy;
  uvec2 at = gl_WorkGroupID.xy * 16u + lane;
  float least = kNothing;
  for (uint i = 0u; i < 4u; ++i) {
    uvec2 quad = 2u * at + uvec2(i & 1u, i >> 1u);
    float depth = min(min(texel(level, 2u * quad), texel(level, 2u * quad + uvec2(1u, 0u))),
                      min(texel(level, 2u * quad + uvec2(0u, 1u)), texel(level, 2u * quad + uvec2(1u, 1u))));
    put(level + 1u, quad, depth);
    least = min(least, depth);
  }
  put(level + 2u, at, least);
  tile[lane.y][lane.x] = least;
  for (uint step = 1u; step < 5u; ++step) {
    uint side = 16u >> step;
    barrier();
    bool within = lane.x < side && lane.y < side;
    if (within) {
      uvec2 from = 2u * lane;
      least = min(min(tile[from.y][from.x], tile[from.y][from.x + 1u]),
                  min(tile[from.y + 1u][from.x], tile[from.y + 1u][from.x + 1u]));
      put(level + 2u + step, gl_WorkGroupID.xy * side + lane, least);
    }
    barrier();
    if (within) tile[lane.y][lane.x] = least;
  }
}
