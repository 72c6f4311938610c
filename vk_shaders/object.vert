#version 460
// Vertices of drawables: by index; or, where holes or glass are to be found, three a slot without one.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"

invariant gl_Position;
layout(location = 0) flat out uint drawable;
#if SL_PLAIN
layout(location = 1) flat out uint slot;
layout(location = 2) out vec2 shares;
#endif

void main() {
  drawable = uint(gl_InstanceIndex);
#if SL_PLAIN
  slot = uint(gl_VertexIndex) / 3u;
  uint corner = uint(gl_VertexIndex) % 3u;
  shares = vec2(corner == 1u ? 1.0f : 0.0f, corner == 2u ? 1.0f : 0.0f);
  gl_Position = clipPosition(SL_DRAW.camera, positionOf(Words(SL_DRAW.indices).at[gl_VertexIndex]));
#else
  gl_Position = clipPosition(SL_DRAW.camera, positionOf(uint(gl_VertexIndex)));
#endif
}
