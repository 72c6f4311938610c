// Which pixels a box may touch, and how near it may be there: never too little, whatever the rounding.
//
// What lies in a box is projected in float (camera.h), moved to the viewport, and snapped to fractions of a
// pixel; so are the box's corners. Of a place p relative to the eye, a coordinate x = p . across errs by at
// most 2^-21 of |p| . |across|, summed by axis: each difference, product and sum rounds once. All is widened
// by twice that. In pixels come 1/64 for the snapping, which Vulkan promises to 1/16 at worst and GPUs do at
// 1/256, and for the viewport's roundings. Depth is widened by 2^-14 of itself: it is interpolated over a
// triangle from three vertices.
#ifndef SL_BOX_EXTENT_H
#define SL_BOX_EXTENT_H
#include "core/shared/camera.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kBoxOutside = 0u;  ///< touches no pixel
SL_CONST uint kBoxNear = 1u;     ///< may reach the near plane: nothing else is known of it
SL_CONST uint kBoxAhead = 2u;    ///< has pixels and a depth

SL_CONST float kExtentGuard = 9.5367431640625e-7f;  // 2^-20
SL_CONST float kPixelGuard = 0.015625f;             // 1/64
SL_CONST float kDepthGuard = 1.00006103515625f;     // 1 + 2^-14

SL_STRUCT(BoxExtent) {
  uvec4 pixels;  ///< first column, first row, last column, last row
  float depth;   ///< none of its pixels is nearer (greater)
  uint place;    ///< kBox...; pixels and depth are those of kBoxAhead only
};

/// Sizes of the terms of a dot product.
SL_FUNC float dotSize(vec3 a, vec3 b) {
  return (fabs(a.x) * fabs(b.x) + fabs(a.y) * fabs(b.y)) + fabs(a.z) * fabs(b.z);
}

/// The largest whole number not above x, of places within or next to an image.
SL_FUNC float wholePixel(float x) {
  float bounded = min(max(x, -32768.0f), 32768.0f);
  float whole = slFloat(slInt(bounded));
  return whole > bounded ? whole - 1.0f : whole;
}

/// Lowest and highest pixel centre within low .. high of the viewport's -1 .. 1, as numbers of pixels; none
/// where the first is above the second.
SL_FUNC vec2 pixelRange(float low, float high, float size) {
  float first = (low * 0.5f + 0.5f) * size - (0.5f + kPixelGuard);
  float last = (high * 0.5f + 0.5f) * size - (0.5f - kPixelGuard);
  return vec2(max(-wholePixel(-first), 0.0f), min(wholePixel(last), size - 1.0f));
}

/// The box must be finite. Divisions need not round correctly here: the guards are wider.
SL_FUNC BoxExtent boxExtent(Camera camera, vec3 low, vec3 high) {
  BoxExtent result;
  result.pixels = uvec4(0u, 0u, 0u, 0u);
  result.depth = 1.0f;
  vec3 eye = xyz3(camera.eye);
  vec3 farthest =
      vec3(max(fabs(low.x - eye.x), fabs(high.x - eye.x)), max(fabs(low.y - eye.y), fabs(high.y - eye.y)),
           max(fabs(low.z - eye.z), fabs(high.z - eye.z)));
  float slack_x = kExtentGuard * dotSize(farthest, xyz3(camera.across));
  float slack_y = kExtentGuard * dotSize(farthest, xyz3(camera.down));
  float slack_w = kExtentGuard * dotSize(farthest, xyz3(camera.forward));
  float x_low = 3.0e38f;
  float x_high = -3.0e38f;
  float y_low = 3.0e38f;
  float y_high = -3.0e38f;
  float nearest = 3.0e38f;
  float last = -3.0e38f;
  for (uint corner = 0u; corner < 8u; ++corner) {
    vec3 point = vec3((corner & 1u) != 0u ? high.x : low.x, (corner & 2u) != 0u ? high.y : low.y,
                      (corner & 4u) != 0u ? high.z : low.z);
    vec4 clip = clipPosition(camera, point);
    float w_low = clip.w - slack_w;
    float w_high = clip.w + slack_w;
    nearest = min(nearest, w_low);
    last = max(last, w_high);
    if (w_low > 0.0f) {
      x_low = min(x_low, min((clip.x - slack_x) / w_low, (clip.x - slack_x) / w_high));
      x_high = max(x_high, max((clip.x + slack_x) / w_low, (clip.x + slack_x) / w_high));
      y_low = min(y_low, min((clip.y - slack_y) / w_low, (clip.y - slack_y) / w_high));
      y_high = max(y_high, max((clip.y + slack_y) / w_low, (clip.y + slack_y) / w_high));
    }
  }
  if (nearest <= camera.eye.w) {
    result.place = last < camera.eye.w ? kBoxOutside : kBoxNear;
    return result;
  }
  vec2 columns = pixelRange(x_low, x_high, slFloat(camera.size.x));
  vec2 rows = pixelRange(y_low, y_high, slFloat(camera.size.y));
  if (!(columns.x <= columns.y) || !(rows.x <= rows.y)) {
    result.place = kBoxOutside;
    return result;
  }
  result.place = kBoxAhead;
  result.pixels = uvec4(slUint(columns.x), slUint(rows.x), slUint(columns.y), slUint(rows.y));
  result.depth = min(camera.eye.w / nearest * kDepthGuard, 1.0f);
  return result;
}

SL_NAMESPACE_END
#endif
