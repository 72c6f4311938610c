#pragma once
#include "core/scene/scene.h"

namespace sightline::testing_support {

/// Builds scenes of rectangles and boxes for golden tests.
class SceneOfBoxes {
 public:
  /// Rectangle corner, corner + u, corner + u + v, corner + v: two triangles; returns the id of the first.
  uint32_t addRectangle(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    const auto first = static_cast<uint32_t>(scene_.positions.size());
    const auto id = static_cast<uint32_t>(scene_.triangles.size());
    for (const glm::vec3 p : {corner, corner + u, corner + u + v, corner + v}) scene_.positions.push_back(p);
    scene_.triangles.push_back({first, first + 1, first + 2});
    scene_.triangles.push_back({first, first + 2, first + 3});
    return id;
  }

  /// Closed box, 12 triangles, pairs in the order -x, +x, -y, +y, -z, +z; returns the id of the first.
  uint32_t addBox(glm::vec3 low, glm::vec3 high) {
    const glm::vec3 s = high - low, x(s.x, 0, 0), y(0, s.y, 0), z(0, 0, s.z);
    const uint32_t id = addRectangle(low, z, y);
    addRectangle(low + x, y, z);
    addRectangle(low, x, z);
    addRectangle(low + y, z, x);
    addRectangle(low, y, x);
    addRectangle(low + z, x, y);
    return id;
  }

  /// One triangle; returns its id.
  uint32_t addTriangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const auto first = static_cast<uint32_t>(scene_.positions.size());
    for (const glm::vec3 p : {a, b, c}) scene_.positions.push_back(p);
    scene_.triangles.push_back({first, first + 1, first + 2});
    return static_cast<uint32_t>(scene_.triangles.size() - 1);
  }

  /// The scene, as one object.
  Scene finish() {
    scene_.objects = {{"all", 0, static_cast<uint32_t>(scene_.triangles.size())}};
    return std::move(scene_);
  }

 private:
  Scene scene_;
};

}  // namespace sightline::testing_support
