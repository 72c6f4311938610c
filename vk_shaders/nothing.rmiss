#version 460
// Passes on that nothing was hit; see trace.glsl.
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT uvec3 found;

void main() {
  found = uvec3(0u, 0xffffffffu, 0u);
}
