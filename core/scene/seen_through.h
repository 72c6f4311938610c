#pragma once
#include <span>

#include "core/base/named_triangles.h"
#include "core/scene/scene.h"

namespace sightline {

/// The scene with some of its triangles as glass: each is seen as if all others of them were away, and none
/// hides anything. So what is seen then holds whatever there is of them at any time.
/// Where there are any, a scene with instances becomes the plain one that it stands for.
Scene seenThrough(Scene scene, std::span<const NamedTriangles> glass);

}  // namespace sightline
