#pragma once
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/scene/scene.h"

namespace sightline {

/// A plain scene without surfaces that is made in pieces, so that it never is in memory as a whole.
struct SceneStream {
  uint32_t vertices = 0;
  Bounds bounds;                     ///< of all vertices
  std::vector<SceneObject> objects;  ///< as of Scene
  /// Calls `take` with all of them, in order.
  std::function<void(const std::function<void(std::span<const glm::vec3>)>& take)> positions;
  std::function<void(const std::function<void(std::span<const glm::uvec3>)>& take)> triangles;

  uint32_t triangleCount() const {
    return objects.empty() ? 0 : objects.back().first_triangle + objects.back().triangle_count;
  }
};

}  // namespace sightline
