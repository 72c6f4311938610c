// Rays from points, and rays in entries of the list.
#ifndef SL_RAY_H
#define SL_RAY_H
#include "core/shared/types.h"
#include "core/shared/vector.h"
SL_NAMESPACE_BEGIN

/// The ray from origin to target: t = 1 there. Without direction where the two coincide.
SL_FUNC Ray rayTo(vec3 origin, vec3 target) {
  vec3 direction = sub3(target, origin);
  Ray ray;
  ray.origin = vec4(origin.x, origin.y, origin.z, 0.0f);
  ray.direction = vec4(direction.x, direction.y, direction.z, 0.0f);
  return ray;
}

/// A ray that hits nothing and is not counted.
SL_FUNC Ray noRay() {
  Ray ray;
  ray.origin = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  ray.direction = ray.origin;
  return ray;
}

SL_FUNC bool hasDirection(Ray ray) {
  return maxAbs3(xyz3(ray.direction)) > 0.0f;
}

/// The first three words as floats.
SL_FUNC vec3 vectorOfBits(uvec4 bits) {
  return vec3(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z));
}

/// The ray that found the entry's triangle.
SL_FUNC Ray entryRay(PvsEntry entry) {
  vec3 origin = vectorOfBits(entry.origin_triangle);
  vec3 direction = vectorOfBits(entry.direction_stage);
  Ray ray;
  ray.origin = vec4(origin.x, origin.y, origin.z, 0.0f);
  ray.direction = vec4(direction.x, direction.y, direction.z, 0.0f);
  return ray;
}

/// The entry of a triangle that a ray of the stage found.
SL_FUNC PvsEntry entryOf(uint triangle, Ray ray, uint stage) {
  vec4 origin = ray.origin;
  vec4 direction = ray.direction;
  PvsEntry entry;
  entry.origin_triangle =
      uvec4(floatBitsToUint(origin.x), floatBitsToUint(origin.y), floatBitsToUint(origin.z), triangle);
  entry.direction_stage =
      uvec4(floatBitsToUint(direction.x), floatBitsToUint(direction.y), floatBitsToUint(direction.z), stage);
  return entry;
}

SL_NAMESPACE_END
#endif
