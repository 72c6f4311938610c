#pragma once
#include <span>

#include "core/scene/scene.h"

namespace sightline {

/// The median length of the triangles' edges that are longer than 0, of an evenly spread part of them in
/// large scenes: the size of the scene's detail, in its units. 0 if no edge has a length. remainders: what
/// each position lost when it was rounded to floats; those behind the end lost nothing.
double medianEdge(const Scene& scene, std::span<const glm::vec3> remainders = {});

}  // namespace sightline
