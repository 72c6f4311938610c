#pragma once
#include <cstdint>

#include "bvh/axis_box.h"
#include "core/shared/camera.h"
#include "core/shared/view_ray.h"

namespace sightline {

/// Largest width and height of an image.
inline constexpr uint32_t kLargestImageSide = 16384;

/// The camera that sees what the view shows: right and up are scaled by the tangents of half the fields of
/// view, and differ in length where the image is not square. near_distance: see nearDistance. The image's
/// proportions are those of the view's vectors: width and height only say how many pixels there are. Throws
/// Error for a width or height of 0 or above kLargestImageSide, and for numbers that are not finite.
Camera makeCamera(const ViewFrame& view, uint32_t width, uint32_t height, float near_distance);

/// A view level with the horizon (y is up; looking straight up or down, -z is): fov is the full angle from
/// top to bottom in degrees, kSmallestFov .. kLargestFov (core/sampling/views.h); across it follows from
/// width / height. Throws Error where eye and look are the same place, or not finite.
ViewFrame lookAt(const glm::dvec3& eye, const glm::dvec3& look, double fov, uint32_t width, uint32_t height);

/// Where to cut: 2^-20 of the largest coordinate or, where this is less, extent of what is drawn, rounded
/// down to a power of two. Floats know places to 2^-24 of the former, so nothing that a viewer tells apart is
/// nearer.
float nearDistance(const AxisBox& bounds);

}  // namespace sightline
