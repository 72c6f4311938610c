#version 460
// Passes on what was hit; see trace.glsl.
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT uvec3 found;

void main() {
  found = uvec3(floatBitsToUint(gl_HitTEXT), uint(gl_InstanceCustomIndexEXT), uint(gl_PrimitiveID));
}
