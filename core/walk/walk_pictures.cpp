#include "core/walk/walk_pictures.h"

#include <algorithm>
#include <cmath>

#include "core/picture/mark_pixels.h"
#include "core/picture/shading.h"
#include "core/walk/replay.h"

namespace sightline {
namespace {

const glm::vec3 kToSun = glm::normalize(glm::vec3(0.5f, 0.8f, 0.35f));

/// An image plane that looks down on the scene, towards -z, without perspective.
class AboveView {
 public:
  AboveView(const Bounds& bounds, uint32_t width) : middle_((bounds.low + bounds.high) * 0.5f) {
    const glm::vec3 half = (bounds.high - bounds.low) * 0.5f;
    const glm::vec3 reach_v = glm::abs(up_) * half;
    half_u_ = std::max(half.x, 1e-6f * glm::length(half)) * 1.03f;
    half_v_ = std::max(reach_v.x + reach_v.y + reach_v.z, half_u_ * 0.3f) * 1.03f;
    width_ = width;
    height_ = std::clamp(uint32_t(float(width) * half_v_ / half_u_), 64u, 2 * width);
    half_v_ = half_u_ * float(height_) / float(width);
    distance_ = 2 * glm::length(half);
  }

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  Ray ray(double x, double y) const {
    const float u = half_u_ * float(2 * x / width_ - 1), v = half_v_ * float(1 - 2 * y / height_);
    return makeRay(middle_ + right_ * u + up_ * v - down_ * distance_, down_);
  }
  glm::dvec2 pixelOf(const glm::vec3& p) const {
    const glm::vec3 at = p - middle_;
    return {(double(glm::dot(at, right_)) / half_u_ + 1) * width_ / 2,
            (1 - double(glm::dot(at, up_)) / half_v_) * height_ / 2};
  }
  glm::vec3 direction() const { return down_; }

 private:
  glm::vec3 middle_, right_{1, 0, 0}, down_ = glm::normalize(glm::vec3(0, -1.0f, -0.55f)),
                                      up_ = glm::cross(right_, down_);
  float half_u_ = 1, half_v_ = 1, distance_ = 1;
  uint32_t width_ = 1, height_ = 1;
};

/// A line of some pixels' width.
void drawLine(Image& image, glm::dvec2 from, glm::dvec2 to, double width, Rgb color) {
  const double length = std::max(1.0, glm::length(to - from));
  const int reach = int(std::ceil(width / 2));
  for (double at = 0; at <= length; at += 0.5) {
    const glm::dvec2 p = from + (to - from) * (at / length);
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const double x = std::floor(p.x) + dx, y = std::floor(p.y) + dy;
        const glm::dvec2 off = glm::dvec2(x + 0.5, y + 0.5) - p;
        if (x < 0 || y < 0 || x >= image.width || y >= image.height || glm::dot(off, off) > width * width / 4)
          continue;
        image.at(uint32_t(x), uint32_t(y)) = color;
      }
    }
  }
}

/// Eye, and the edges of what it sees for a part of the scene's extent.
void drawCamera(Image& image, const AboveView& view, const Camera& camera, float extent) {
  const glm::vec3 eye(camera.eye), forward(camera.forward), across(camera.across), low(camera.down);
  const glm::vec3 a = across / glm::dot(across, across), b = low / glm::dot(low, low);
  glm::dvec2 far[4];
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 corner = forward + a * (i == 0 || i == 3 ? -1.0f : 1.0f) + b * (i < 2 ? -1.0f : 1.0f);
    far[i] = view.pixelOf(eye + glm::normalize(corner) * extent);
  }
  const Rgb color = encode(kCellColor);
  for (int i = 0; i < 4; ++i) {
    drawLine(image, view.pixelOf(eye), far[i], 2.5, color);
    drawLine(image, far[i], far[(i + 1) % 4], 1.5, color);
  }
  drawLine(image, view.pixelOf(eye), view.pixelOf(eye), 11, color);
}

}  // namespace

Image falsePicture(const Scene& scene, Tracer& tracer, const Camera& camera, std::span<const size_t> pixels) {
  Image image(camera.size.x, camera.size.y);
  std::vector<Ray> rays;
  for (uint32_t y = 0; y < image.height; ++y) {
    for (uint32_t x = 0; x < image.width; ++x) rays.push_back(pixelRay(camera, x, y));
  }
  std::vector<Hit> hits(rays.size());
  tracer.traceRays(rays, hits);
  for (size_t i = 0; i < rays.size(); ++i) {
    const glm::vec3 direction = glm::normalize(glm::vec3(rays[i].direction));
    image.pixels[i] = encode(
        hits[i].triangle == kNoTriangle
            ? skyColor(std::max(0.0f, direction.y))
            : kHiddenColor * lightOn(facingNormal(scene, hits[i].triangle, direction), direction, kToSun, 1));
  }
  markMissing(image, pixels);
  return image;
}

Image drawnPicture(const Scene& scene, Tracer& tracer, const Drawables& drawables,
                   std::span<const uint32_t> drawn, const Camera& camera, uint32_t size) {
  const Bounds bounds = sceneBounds(scene);
  const AboveView view(bounds, size);
  std::vector<uint8_t> is_drawn(scene.triangleCount(), 0);
  for (const uint32_t drawable : drawn) {
    for (const uint32_t id : drawables.trianglesOf(drawable)) is_drawn[id] = 1;
  }
  Image image(view.width(), view.height());
  const float away = glm::length(bounds.high - bounds.low) * 1e-5f;
  renderTile(
      [&](std::span<const Ray> rays, std::span<Hit> hits) { tracer.traceRays(rays, hits); },
      [&](std::span<const Ray> rays, std::span<const Hit> hits) { return tracer.traceGlass(rays, hits); },
      {0, 0, image.width, image.height},
      [&](uint32_t x, uint32_t y) {
        return view.ray((x + 0.5) / kSamplesPerAxis, (y + 0.5) / kSamplesPerAxis);
      },
      [&](const Ray& ray, const Hit& hit) {
        const glm::vec3 direction(ray.direction);
        const glm::vec3 place = glm::vec3(ray.origin) + direction * hit.t;
        return makeRay(place + facingNormal(scene, hit.triangle, direction) * away, kToSun);
      },
      [&](uint32_t x, uint32_t y, std::span<const Sample> samples) {
        glm::vec3 light(0);
        for (const auto& [ray, hit, shadow_hit, panes] : samples) {
          glm::vec3 behind(0.97f);
          if (hit.triangle != kNoTriangle) {
            const float sunlit = shadow_hit.triangle == kNoTriangle ? 1.0f : 0.0f;
            const glm::vec3 color = is_drawn[hit.triangle] != 0 ? kVisibleColor * 1.2f : kHiddenColor;
            behind = color * lightOn(facingNormal(scene, hit.triangle, view.direction()), view.direction(),
                                     kToSun, sunlit);
          }
          light += throughGlass(scene, behind, panes, view.direction(), kToSun, [&](uint32_t id) {
            return is_drawn[id] != 0 ? kVisibleGlassColor : kHiddenGlassColor;
          });
        }
        image.at(x, y) = encode(light / float(samples.size()));
      });
  drawCamera(image, view, camera, 0.12f * glm::length(bounds.high - bounds.low));
  return image;
}

}  // namespace sightline
