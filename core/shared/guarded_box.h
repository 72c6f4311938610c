// A box grown so that its faces, drawn, lie before or on whatever in it covers a pixel: what
// core/draw/box_guard.h does in double for queries, here in float, and therefore by twice as much.
#ifndef SL_GUARDED_BOX_H
#define SL_GUARDED_BOX_H
#include "core/shared/box_extent.h"
SL_NAMESPACE_BEGIN

SL_STRUCT(GuardedBox) {
  vec3 low;
  vec3 high;
  bool whole;  ///< it stays behind the near plane: else it cannot be drawn whole
};

/// shrink: pixels that the box is made smaller by, all around, instead of grown: a fault, for tests of tests;
/// else 0.
SL_FUNC GuardedBox guardBox(Camera camera, vec3 low, vec3 high, float shrink) {
  vec3 eye = xyz3(camera.eye);
  float reach = 0.0f;
  float largest = -3.0e38f;
  float least = 3.0e38f;
  for (uint corner = 0u; corner < 8u; ++corner) {
    vec3 point = vec3((corner & 1u) != 0u ? high.x : low.x, (corner & 2u) != 0u ? high.y : low.y,
                      (corner & 4u) != 0u ? high.z : low.z);
    float distance = clipPosition(camera, point).w;
    largest = max(largest, distance);
    least = min(least, distance);
    reach = max(reach, max(maxAbs3(point), maxAbs3(sub3(point, eye))));
  }
  // At distance d the image is 2 d / |across| wide; shortened lengths only make pixels larger.
  float pixel = max(2.0f / (maxAbs3(xyz3(camera.across)) * slFloat(camera.size.x)),
                    2.0f / (maxAbs3(xyz3(camera.down)) * slFloat(camera.size.y)));
  float by = reach * 1.9073486e-6f + largest * (pixel * (shrink > 0.0f ? -shrink : 0.015625f)) +
             largest * (largest / max(least, camera.eye.w)) * 1.9073486e-6f;
  GuardedBox result;
  result.low = vec3(low.x - by, low.y - by, low.z - by);
  result.high = vec3(high.x + by, high.y + by, high.z + by);
  float slack =
      by * (fabs(camera.forward.x) + fabs(camera.forward.y) + fabs(camera.forward.z)) + reach * 1.9073486e-6f;
  result.whole = least - slack > max(camera.eye.w, 0.5f * least);
  return result;
}

SL_NAMESPACE_END
#endif
