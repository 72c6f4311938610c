// Vector arithmetic with a fixed order of operations: built-in dot, cross and normalize may fuse or reorder,
// so that devices would differ in the last bit.
#ifndef SL_VECTOR_H
#define SL_VECTOR_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

SL_FUNC float dot3(vec3 a, vec3 b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

SL_FUNC vec3 cross3(vec3 a, vec3 b) {
  return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

SL_FUNC vec3 add3(vec3 a, vec3 b) {
  return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}
SL_FUNC vec3 sub3(vec3 a, vec3 b) {
  return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}
SL_FUNC vec3 scale3(vec3 a, float s) {
  return vec3(a.x * s, a.y * s, a.z * s);
}
SL_FUNC vec3 xyz3(vec4 a) {
  return vec3(a.x, a.y, a.z);
}

/// Largest absolute component.
SL_FUNC float maxAbs3(vec3 a) {
  return max(max(fabs(a.x), fabs(a.y)), fabs(a.z));
}

/// Euclidean length; 0 for the zero vector. Components up to 1e18 and down to 1e-18 keep full precision.
SL_FUNC float length3(vec3 a) {
  return sqrt(dot3(a, a));
}

/// Unit vector; the zero vector stays zero.
SL_FUNC vec3 normalize3(vec3 a) {
  float length = length3(a);
  return length > 0.0f ? vec3(slDivide(a.x, length), slDivide(a.y, length), slDivide(a.z, length)) : a;
}

SL_NAMESPACE_END
#endif
