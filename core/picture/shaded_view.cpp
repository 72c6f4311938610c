#include "core/picture/shaded_view.h"

#include <algorithm>
#include <limits>

#include "core/picture/shading.h"

namespace sightline {
namespace {

/// Shadow rays start this share of the scene's size beside the surface: far above the rounding of a hit's
/// place, far below a pixel.
constexpr float kShadowOffset = 0x1p-17f;

/// Over the viewer's left shoulder, 50 degrees high: what faces the viewer is lit, and shadows fall aside.
glm::vec3 sunFor(const PictureCamera& camera) {
  const glm::dvec3 back = glm::normalize(glm::dvec3(-camera.forward.x, 0, -camera.forward.z));
  return glm::vec3(glm::normalize(0.45 * back - 0.75 * camera.right + glm::dvec3(0, 1.05, 0)));
}

glm::vec3 hitPlace(const Ray& ray, const Hit& hit) {
  return glm::vec3(ray.origin) + hit.t * glm::vec3(ray.direction);
}

}  // namespace

ShadedView renderShaded(const TraceRays& trace, const Scene& scene, const OutsideView& view,
                        const TriangleColors& colors, const PictureOptions& options,
                        const TraceGlass& glass) {
  const PictureCamera& camera = view.camera;
  const Bounds bounds = sceneBounds(scene);
  const float shadow_offset = kShadowOffset * glm::length(bounds.high - bounds.low);
  const glm::vec3 to_sun = sunFor(camera);

  ShadedView shaded;
  Picture& picture = shaded.picture;
  picture.image = Image(options.width, options.height);
  std::vector<float>& depths = shaded.depths;
  depths.assign(picture.image.pixels.size(), std::numeric_limits<float>::infinity());

  const auto sample_ray = [&](uint32_t x, uint32_t y) {
    const glm::dvec3 direction = camera.direction((x + 0.5) / (options.width * kSamplesPerAxis),
                                                  (y + 0.5) / (options.height * kSamplesPerAxis));
    return cutRay(camera.position, direction, view.cut_height);
  };
  const auto shadow_ray = [&](const Ray& ray, const Hit& hit) {
    const glm::vec3 normal = facingNormal(scene, hit.triangle, glm::vec3(ray.direction));
    return makeRay(hitPlace(ray, hit) + normal * shadow_offset, to_sun);
  };
  const auto sunlit = [&](const glm::vec3& place, const Hit& shadow) {
    if (shadow.triangle == kNoTriangle) return 1.0f;
    return view.cut_height && place.y + shadow.t * to_sun.y > *view.cut_height ? 1.0f : 0.0f;
  };
  const auto shade = [&](uint32_t x, uint32_t y, std::span<const Sample> samples) {
    glm::vec3 sum(0);
    float& depth = depths[size_t(y) * options.width + x];
    bool shows_scene = false;
    for (const auto& [ray, hit, shadow_hit, panes] : samples) {
      glm::vec3 color = skyColor(1 - (float(y) + 0.5f) / float(options.height));
      const bool on_scene = hit.triangle != kNoTriangle;
      shows_scene |= on_scene || !panes.empty();
      const glm::vec3 direction =
          on_scene || !panes.empty() ? glm::normalize(glm::vec3(ray.direction)) : glm::vec3(0);
      if (on_scene) {
        const glm::vec3 place = hitPlace(ray, hit);
        depth = std::min(depth, float(glm::dot(glm::dvec3(place) - camera.position, camera.forward)));
        const glm::vec3 normal = facingNormal(scene, hit.triangle, direction);
        color = colors.solid(hit.triangle) * lightOn(normal, direction, to_sun, sunlit(place, shadow_hit));
      }
      sum += throughGlass(scene, color, panes, direction, to_sun, colors.glass);
    }
    picture.scene_pixels += shows_scene ? 1 : 0;
    picture.image.at(x, y) = encode(sum / float(samples.size()));
  };
  renderTile(trace, glass, {0, 0, options.width, options.height}, sample_ray, shadow_ray, shade);
  return shaded;
}

}  // namespace sightline
