// Any-hit shaders: the ray, and the leaf that the driver asks about.
#ifndef SL_CANDIDATE_GLSL
#define SL_CANDIDATE_GLSL
#extension GL_EXT_ray_tracing : require
#include "vk_shaders/payload.glsl"
#include "vk_shaders/surfaces.glsl"
layout(location = 0) rayPayloadInEXT SL_PAYLOAD carried;

Ray rayOfCandidate() {
  return Ray(vec4(gl_WorldRayOriginEXT, 0.0f), vec4(gl_WorldRayDirectionEXT, 0.0f));
}

uint partOfCandidate() {
  return uint(gl_InstanceCustomIndexEXT);
}

uint leafOfCandidate() {
  return leafOf(partOfCandidate(), uint(gl_PrimitiveID));
}

#endif
