#pragma once
#include <span>
#include <string>

#include "core/scene/scene.h"

namespace sightline {

/// A line if single precision spoils the scene, else empty. It does
/// - if triangles that have a shape in the file have no area any more, or
/// - if the scene lies far from the origin for its size, and the steps between floats at its coordinates are
/// coarser
///   than a thousandth of the median edge.
/// `remainders`: what each position lost when it was rounded to floats; those behind the end lost nothing.
/// Needs scene.degenerate_triangles.
std::string precisionWarning(const Scene& scene, std::span<const glm::vec3> remainders);

}  // namespace sightline
