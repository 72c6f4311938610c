// Where a point of the scene lands in an image of any width and height: the one function that the processor's
// drawing and every vertex shader share, so that all draw the same depth, bit for bit.
//
// Depth is reversed, without a far plane: near / distance, where distance is measured along `forward`. It
// falls from 1 at the near plane towards 0, and greater is nearer; a depth image starts as 0.
#ifndef SL_CAMERA_H
#define SL_CAMERA_H
#include "core/shared/vector.h"
SL_NAMESPACE_BEGIN

/// A pinhole camera and its image. 80 bytes; core/draw/make_camera.h makes it.
///
///   -1,-1 +----------+          x to the right, y down, as Vulkan's viewports have them; what is nearer
///         |    o---> | across   than the near plane is cut off, and there are no other planes but the
///         |    v     |          image's four edges
///         +----------+ 1,1
///            down
SL_STRUCT(Camera) {
  vec4 eye;      ///< xyz: where it is, w: distance of the near plane, above 0
  vec4 forward;  ///< xyz: unit vector
  vec4 across;   ///< xyz: unit vector to the right, over the tangent of half the field of view across
  vec4 down;   ///< xyz: unit vector downwards, over the tangent of half the field of view from top to bottom
  uvec4 size;  ///< x: width, y: height in pixels, 1 .. 16,384
};

/// Homogeneous position: x / w and y / w are in the image within [-1, 1], z / w is the depth, w the distance
/// along `forward`. Three differences and three dot products in a fixed order, nothing contracted.
SL_FUNC vec4 clipPosition(Camera camera, vec3 point) {
  vec3 from_eye = sub3(point, xyz3(camera.eye));
  return vec4(dot3(from_eye, xyz3(camera.across)), dot3(from_eye, xyz3(camera.down)), camera.eye.w,
              dot3(from_eye, xyz3(camera.forward)));
}

SL_NAMESPACE_END
#endif
