#version 460
// Passes on that nothing was hit; see payload.glsl.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_tracing : require
#include "vk_shaders/payload.glsl"
layout(location = 0) rayPayloadInEXT SL_PAYLOAD carried;

void main() {
  carried.xyz = uvec3(0u, 0xffffffffu, 0u);
}
