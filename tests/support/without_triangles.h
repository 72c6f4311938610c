#pragma once
#include <span>

#include "core/base/named_triangles.h"
#include "core/scene/scene.h"

namespace sightline::testing_support {

/// The scene as if some of its triangles were not there; all others keep their ids. Those left out stay as
/// triangles without area (a vertex three times).
inline Scene withoutTriangles(Scene scene, std::span<const NamedTriangles> left_out) {
  for (const NamedTriangles& range : left_out) {
    for (uint32_t id = range.first; id - range.first < range.count; ++id) {
      scene.triangles[id] = glm::uvec3(scene.triangles[id].x);
    }
  }
  return scene;
}

}  // namespace sightline::testing_support
