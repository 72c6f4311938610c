#include "core/walk/alpha_cover.h"

#include "core/scene/scene_tree.h"
#include "core/walk/replay.h"

namespace sightline {
namespace {

/// What a pixel shows may be such a surface itself: it lies there but for the rounding of depth.
constexpr double kBefore = 1 - 0x1p-16;

}  // namespace

AlphaCover::AlphaCover(const Scene& scene, const Drawables& drawables) {
  for (uint32_t d = 0; d < drawables.list.size(); ++d) {
    if (drawables.list[d].alpha == AlphaKind::opaque) continue;
    for (const uint32_t id : drawables.trianglesOf(d)) covers_.triangles.push_back(scene.triangles[id]);
  }
  if (covers_.triangles.empty()) return;
  covers_.positions = scene.positions;
  bvh_ = buildSceneTree(covers_);
  tracer_.emplace(covers_, bvh_);
}

uint64_t AlphaCover::count(const Camera& camera, std::span<const size_t> pixels,
                           std::span<const float> depth) const {
  if (!any()) return 0;
  uint64_t covered = 0;
  for (const size_t pixel : pixels) {
    const Ray ray = pixelRay(camera, uint32_t(pixel % camera.size.x), uint32_t(pixel / camera.size.x));
    const double speed = glm::dot(glm::dvec3(camera.forward), glm::dvec3(ray.direction));
    const double shown = camera.eye.w / double(depth[pixel]) / speed;  // where the ray meets what is shown
    const Hit hit = tracer_->trace(ray);
    covered += hit.triangle != kNoTriangle && hit.t < shown * kBefore ? 1 : 0;
  }
  return covered;
}

}  // namespace sightline
