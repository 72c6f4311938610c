#pragma once
#include <algorithm>

#include "core/scene/scene.h"

namespace sightline {

/// The object, by its place in Scene::objects, that a triangle is of.
inline uint32_t objectOf(const Scene& scene, uint32_t triangle) {
  const auto after =
      std::upper_bound(scene.objects.begin(), scene.objects.end(), triangle,
                       [](uint32_t id, const SceneObject& o) { return id < o.first_triangle; });
  return after == scene.objects.begin() ? 0 : uint32_t(after - scene.objects.begin()) - 1;
}

}  // namespace sightline
