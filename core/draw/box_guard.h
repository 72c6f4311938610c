#pragma once
#include <optional>

#include "core/draw/frustum.h"

namespace sightline {

/// Grows boxes before they are drawn for a query, by at least what drawing may take from them or add to what
/// they hold:
///
/// - 2^-20 of their coordinates and of their distance from the eye on each axis, for the rounding of
///   positions;
/// - 1/128 pixel at their largest depth: devices snap corners to 1/256 pixel (subPixelPrecisionBits of 8 or
///   more), so that a box and a triangle in it may each be moved by half of that, in opposite directions;
/// - 2^-20 of largest depth squared over least: depth is linear in the image, and devices find it there to
///   about 2^-22 of the greatest (the nearest) that a face has, which far away is more than places are known
///   to. That is what a triangle may lose and a box, up to twice as near, may gain.
///
/// None of this bounds a triangle narrower than a hundredth of a pixel, of which a device may take the depth at
/// a place beside it, off all of its corners (docs/walk.md).
///
/// So whatever in the box covers a pixel of an image lies, there, behind the grown box's faces, or on them.
/// Boxes in a box grow to boxes in the grown one.
class BoxGuard {
 public:
  explicit BoxGuard(const Camera& camera);

  /// The grown box; nothing where it would reach the near plane, or be less than half as far as the box: such
  /// a box cannot be asked about, as its faces are cut away there, or as its depth is off by too much. What
  /// holds the camera, and what is partly behind it, is among them.
  std::optional<AxisBox> grown(const AxisBox& box) const;

  const Frustum& frustum() const { return frustum_; }

 private:
  Frustum frustum_;
  glm::dvec3 eye_;
  double near_;
  double pixel_;  ///< 1/128 pixel's extent at distance 1, on the axis where pixels are larger
};

}  // namespace sightline
