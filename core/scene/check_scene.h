#pragma once
#include "core/scene/scene.h"

namespace sightline {

/// Throws Error if the scene breaks an invariant of Scene: no triangle, too many, an index out of range, a
/// coordinate of a triangle that is not finite or too large, objects that do not cover the triangles. No
/// objects at all are fine. What loadScene made passes.
void checkScene(const Scene& scene);

}  // namespace sightline
