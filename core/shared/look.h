// Which way a view cell looks. Boxes and sheets look all around: from any of their points a ray either leaves
// at once or runs inside first. A flat cell looks along its normal only, so no ray of any stage may run along
// its plane or behind it.
//
//               normal                  A triangle through the plane counts by its front part: the long edges
//        front  |    / triangle         of its border polygon are cut off where the cell no longer looks.
//               |   /
//   ----cell====+--x-------- plane
//                 /      behind
#ifndef SL_LOOK_H
#define SL_LOOK_H
#include "core/shared/ray.h"
#include "core/shared/stage_params.h"
SL_NAMESPACE_BEGIN

/// A flat cell's rays rise from its plane by more than this share of their largest component. Then they do by
/// exact arithmetic, too: the rounding of direction, normal and product is below 13 * 2^-24.
SL_CONST float kLeastSlope = 9.5367431640625e-7f;  // 2^-20
/// Slope at which border polygons are cut off: so far above kLeastSlope that rounding cannot take what is
/// left.
SL_CONST float kCutSlope = 3.0517578125e-5f;  // 2^-15

/// Whether the cell looks along its normal only.
SL_FUNC bool looksOneWay(StageParams params) {
  return maxAbs3(xyz3(params.look)) > 0.0f;
}

/// Whether a ray from the cell may run along `direction`. NaN: no for flat cells.
SL_FUNC bool looksAlong(vec3 direction, StageParams params) {
  if (!looksOneWay(params)) return true;
  return dot3(direction, xyz3(params.look)) > kLeastSlope * maxAbs3(direction);
}

/// The ray; without direction where the cell does not look along it.
SL_FUNC Ray whereCellLooks(Ray ray, StageParams params) {
  if (!looksAlong(xyz3(ray.direction), params)) ray.direction = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  return ray;
}

SL_NAMESPACE_END
#endif
