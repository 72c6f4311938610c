#include "core/scene/seen_through.h"

#include <utility>

#include "core/scene/instances.h"

namespace sightline {

Scene seenThrough(Scene scene, std::span<const NamedTriangles> glass) {
  if (glass.empty()) return scene;
  scene = flatten(std::move(scene));  // an object may be one place of a mesh
  scene.surfaces.words.resize(scene.triangleCount(), 0);
  for (const NamedTriangles& range : glass) {
    for (uint32_t id = range.first; id - range.first < range.count; ++id) {
      scene.surfaces.words[id] |= kSurfaceGlass;
    }
  }
  return scene;
}

}  // namespace sightline
