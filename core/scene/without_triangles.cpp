#include "core/scene/without_triangles.h"

namespace sightline {

Scene withoutTriangles(Scene scene, std::span<const NamedTriangles> left_out) {
  for (const NamedTriangles& range : left_out) {
    for (uint32_t id = range.first; id - range.first < range.count; ++id) {
      scene.triangles[id] = glm::uvec3(scene.triangles[id].x);
    }
  }
  return scene;
}

}  // namespace sightline
