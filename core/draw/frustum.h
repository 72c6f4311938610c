#pragma once
#include "bvh/axis_box.h"
#include "core/shared/camera.h"

namespace sightline {

/// Where a box lies to what the camera's image shows.
enum class FrustumSide {
  outside,  ///< nothing in it can cover a pixel
  meets,    ///< perhaps
  inside,   ///< nor can anything in it lie outside
};

/// Tests boxes against the image's four edges and the near plane. Errs to one side only: what clipPosition
/// (core/shared/camera.h), in single precision, takes into the image is never outside. Exact up to 2^-20 of
/// the box's distance from the eye, at any scale.
class Frustum {
 public:
  explicit Frustum(const Camera& camera);

  FrustumSide sideOf(const AxisBox& box) const;

  /// Least and largest distance along `forward` of a point in the box, as clipPosition may find it.
  struct Distances {
    double least, largest;
  };
  Distances distancesOf(const AxisBox& box) const;

 private:
  /// Points p with normal . (p - eye) >= offset are on the inner side.
  struct Plane {
    glm::dvec3 normal;
    double offset;
    glm::dvec3 rounding;  ///< sizes of what is added up to the normal
  };
  glm::dvec3 eye_;
  Plane planes_[5];
  Plane depth_;
};

}  // namespace sightline
