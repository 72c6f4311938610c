// Rays from points.
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

SL_NAMESPACE_END
#endif
