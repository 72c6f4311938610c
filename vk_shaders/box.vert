#version 460
// Boxes as strips of 14 vertices. Queries give six floats a box; SL_FLAGS: boxes of the units that are asked of, grown
// as queries' are, and nothing of the others.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"
#include "core/shared/guarded_box.h"

invariant gl_Position;
#if SL_FLAGS
layout(location = 0) flat out uint unit;
#endif

void main() {
  uint bit = 1u << uint(gl_VertexIndex);
#if SL_FLAGS
  unit = push.numbers.x + uint(gl_InstanceIndex);
  CullUnit its = Units(SL_CULL.units).at[unit];
  GuardedBox box = guardBox(SL_DRAW.camera, its.low.xyz, its.high.xyz, SL_CULL.shrink);
  vec3 low = box.low;
  vec3 high = box.high;
#else
  Floats box = Floats(push.other + 24ul * uint(gl_InstanceIndex));
  vec3 low = vec3(box.at[0], box.at[1], box.at[2]);
  vec3 high = vec3(box.at[3], box.at[4], box.at[5]);
#endif
  gl_Position = clipPosition(SL_DRAW.camera, vec3((0x287au & bit) != 0u ? high.x : low.x, (0x02afu & bit) != 0u ? high.y : low.y,
                                                  (0x31e3u & bit) != 0u ? high.z : low.z));
#if SL_FLAGS
  if ((Words(SL_CULL.states).at[unit] & kUnitAsked) == 0u) gl_Position = vec4(0.0f, 0.0f, 0.0f, -1.0f);
#endif
}
