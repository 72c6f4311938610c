#pragma once
#include <span>

#include "core/base/named_triangles.h"
#include "core/scene/scene.h"

namespace sightline {

/// The scene without some of its triangles, as if they were not there: no ray meets them. All others keep
/// their ids; those left out stay as triangles without area (a vertex three times).
Scene withoutTriangles(Scene scene, std::span<const NamedTriangles> left_out);

}  // namespace sightline
