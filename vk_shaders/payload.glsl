// What a ray of a ray tracing pipeline carries. To the nearest hit: x: bits of t, y: instance's custom index or
// kNoTriangle, z: primitive; in scenes with glass w: whether it met any. Over glass: x: action, y: index of the ray, z:
// bits of the farthest t, and back in w whether the set lacks any.
#ifndef SL_PAYLOAD_GLSL
#define SL_PAYLOAD_GLSL
#if SL_HAS_GLASS
#define SL_PAYLOAD uvec4
#else
#define SL_PAYLOAD uvec3
#endif
#endif
