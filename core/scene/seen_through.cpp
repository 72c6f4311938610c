#include "core/scene/seen_through.h"

#include <utility>

#include "core/scene/instances.h"

namespace sightline {

Scene seenThrough(Scene scene, std::span<const NamedTriangles> glass) {
  if (glass.empty()) return scene;
  scene = flatten(std::move(scene));  // surfaces are kept for each triangle, not for those of meshes
  scene.surfaces.words.resize(scene.triangleCount(), 0);
  for (const NamedTriangles& range : glass) {
    for (uint32_t id = range.first; id - range.first < range.count; ++id) {
      scene.surfaces.words[id] |= kSurfaceGlass;
    }
  }
  return scene;
}

}  // namespace sightline
