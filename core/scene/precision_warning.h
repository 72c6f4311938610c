#pragma once
#include <span>
#include <string>

#include "core/scene/scene.h"

namespace sightline {

/// What is to be taken off the scene's coordinates so that floats hold it: for each axis along which it lies
/// far from the origin for its size, its middle as a round, whole number; 0 for the others, and for all where
/// floats do hold the scene: where they step, at its coordinates, by no more than a thousandth of the median
/// edge, and no triangle that has a shape in the file is without area. `remainders`: what each position lost
/// when it was rounded to floats; those behind the end lost nothing. Needs scene.degenerate_triangles.
glm::dvec3 neededOffset(const Scene& scene, std::span<const glm::vec3> remainders);

/// A line if single precision spoils the scene although its offset is off, else empty. It does
/// - if triangles that have a shape in the file have no area any more, or
/// - if the scene lies, or lay, far from the origin for its size, and its coordinates step by more than a
///   thousandth of the median edge: as floats do where they are now or, with `file_has_floats`, where they
///   were in the file.
/// Needs scene.degenerate_triangles.
std::string precisionWarning(const Scene& scene, std::span<const glm::vec3> remainders,
                             bool file_has_floats = false);

}  // namespace sightline
