#pragma once
// Scenes of objects, cameras, and what brute force says of a frame.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/draw/cull_method.h"
#include "core/draw/draw_scene.h"
#include "core/draw/make_camera.h"
#include "core/draw/pvs_units.h"
#include "core/draw/software_backend.h"
#include "core/generate/generate.h"
#include "tests/support/boxes.h"

namespace sightline::draw_cases {

/// A scene of boxes and rectangles, each an object of its own.
class ObjectScene {
 public:
  uint32_t box(glm::vec3 low, glm::vec3 high) { return add(boxes_.addBox(low, high), 12); }
  uint32_t rectangle(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    return add(boxes_.addRectangle(corner, u, v), 2);
  }

  /// May be called once.
  Scene finish() {
    Scene scene = boxes_.finish();
    scene.objects = objects_;
    return scene;
  }

 private:
  /// Returns the object's number.
  uint32_t add(uint32_t first, uint32_t count) {
    objects_.push_back({"object", first, count});
    return uint32_t(objects_.size() - 1);
  }
  testing_support::SceneOfBoxes boxes_;
  std::vector<SceneObject> objects_;
};

inline Camera cameraAt(const DrawScene& scene, glm::dvec3 eye, glm::dvec3 look, uint32_t width = 160,
                       uint32_t height = 120, double fov = 60) {
  return makeCamera(lookAt(eye, look, fov, width, height), width, height,
                    nearDistance(boundsOf(scene.drawables)));
}

/// What a frame must show: all opaque and masked triangles drawn, and the blended drawables that have a pixel
/// then.
struct Truth {
  std::vector<float> depth;
  std::set<uint32_t> drawables;  ///< with a pixel
};

inline Truth bruteForce(const Scene& scene, const DrawScene& parts, const Camera& camera) {
  SoftwareImage image(scene);
  image.begin(camera);
  const auto owner = drawableOfTriangles(parts.drawables);
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    if (parts.drawables.list[owner[id]].alpha != AlphaKind::blended) image.draw(id);
  }
  Truth truth{image.depth(), {}};
  for (const uint32_t id : image.ids()) {
    if (id != kNoTriangle) truth.drawables.insert(owner[id]);
  }
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    if (parts.drawables.list[owner[id]].alpha == AlphaKind::blended && image.draw(id, false)) {
      truth.drawables.insert(owner[id]);
    }
  }
  return truth;
}

/// How a frame differs from what it must show.
struct Wrong {
  uint64_t false_pixels = 0;       ///< whose depth is another
  uint64_t missing_drawables = 0;  ///< that have a pixel, but were not drawn
  bool any() const { return false_pixels > 0 || missing_drawables > 0; }
};

inline Wrong compare(const Truth& truth, const SoftwareImage& image, const std::vector<uint32_t>& drawn) {
  Wrong wrong;
  for (size_t i = 0; i < truth.depth.size(); ++i) wrong.false_pixels += truth.depth[i] != image.depth()[i];
  const std::set<uint32_t> all(drawn.begin(), drawn.end());
  for (const uint32_t d : truth.drawables) wrong.missing_drawables += !all.contains(d);
  return wrong;
}

/// Frames of a walk down a street of the generated city, with a fast turn, a cut and a rise.
inline std::vector<Camera> cityWalk(const DrawScene& scene, uint32_t frames, uint32_t width,
                                    uint32_t height) {
  const AxisBox bounds = boundsOf(scene.drawables);
  const glm::dvec3 low(bounds.low), size = glm::dvec3(bounds.high) - low;
  std::vector<Camera> cameras;
  for (uint32_t f = 0; f < frames; ++f) {
    const double t = double(f) / frames;
    glm::dvec3 eye(low.x + size.x * (0.45 + 0.1 * t), 1.7, low.z + size.z * (0.1 + 0.7 * t));
    glm::dvec3 along(0.1, 0, 1);
    if (t > 0.3 && t < 0.5) along = {1 - 10 * (t - 0.4), 0, 10 * (t - 0.4)};  // turns fast
    if (t >= 0.5 && t < 0.7) {                                                // elsewhere at once
      eye = {low.x + size.x * 0.8, 1.7, low.z + size.z * (1.2 - t)};
      along = {-0.5, 0.02, -1};
    }
    if (t >= 0.7) {  // rises over all of it
      eye.y += (t - 0.7) * 0.5 * size.x;
      along.y = -(t - 0.7);
    }
    cameras.push_back(cameraAt(scene, eye, eye + along, width, height));
  }
  return cameras;
}

}  // namespace sightline::draw_cases
