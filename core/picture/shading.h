#pragma once
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/picture/picture.h"
#include "core/scene/scene.h"

namespace sightline {

/// Colours of the pictures, linear light.
inline constexpr glm::vec3 kVisibleColor{0.10f, 0.50f, 0.16f};
inline constexpr glm::vec3 kHiddenColor{0.50f, 0.51f, 0.53f};
inline constexpr glm::vec3 kOpenColor{0.72f, 0.50f, 0.06f};
inline constexpr glm::vec3 kProvedHiddenColor{0.17f, 0.18f, 0.21f};
inline constexpr glm::vec3 kVisibleGlassColor{0.05f, 0.52f, 0.44f};
inline constexpr glm::vec3 kHiddenGlassColor{0.33f, 0.42f, 0.56f};
inline constexpr glm::vec3 kCellColor{1.0f, 0.33f, 0.0f};

/// Samples along each side of a pixel.
inline constexpr uint32_t kSamplesPerAxis = 2;

/// Throws Error for a picture that is too small or too large.
void checkSize(uint32_t width, uint32_t height);

/// Is triangle t in the set? One byte a triangle of the scene. Throws Error for an id out of range.
std::vector<uint8_t> membership(const Scene& scene, std::span<const uint32_t> triangles);

/// Unit normal of a triangle on the side that `direction` comes from; -direction for a degenerate one.
glm::vec3 facingNormal(const Scene& scene, uint32_t triangle, glm::vec3 direction);

/// Light on a surface: sky from above, a sun (shadowed where sunlit is 0), a little from the sun's other side
/// and from the viewer, so that no two sides of a house look alike. to_sun, normal and direction are unit
/// vectors.
float lightOn(glm::vec3 normal, glm::vec3 direction, glm::vec3 to_sun, float sunlit);

/// What is behind glass, and the glass before it, in whatever order: flat on it, more than half of the light
/// passes each pane, at a slant less. color: of a pane by its triangle. direction: of the ray.
glm::vec3 throughGlass(const Scene& scene, glm::vec3 behind, std::span<const SeenThrough> glass,
                       glm::vec3 direction, glm::vec3 to_sun,
                       const std::function<glm::vec3(uint32_t triangle)>& color);

/// A ray from `origin`; a zero direction marks a sample that shows nothing.
Ray makeRay(glm::vec3 origin, glm::vec3 direction);

/// From linear light, 0..1, to a pixel.
Rgb encode(glm::vec3 linear);

/// From a pixel to linear light.
glm::vec3 decode(Rgb pixel);

/// Background at a height of the picture: 0 bottom, 1 top.
glm::vec3 skyColor(float height);

/// A rectangle of an image, pixels.
struct Tile {
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

/// One sample: where its ray starts and goes. sample_x and sample_y count samples from the tile's upper left
/// corner, (x + 0.5) / (width * kSamplesPerAxis) is the place in the tile.
using SampleRay = std::function<Ray(uint32_t sample_x, uint32_t sample_y)>;

/// What a sample met.
struct Sample {
  Ray ray;
  Hit hit;
  Hit shadow_hit;  ///< of shadow_ray, where there is one
  std::span<const SeenThrough> glass;
};

/// The samples of one pixel, and where in the image it is.
using ShadePixel = std::function<void(uint32_t x, uint32_t y, std::span<const Sample> samples)>;

/// Ray towards the light from the place that a sample met.
using ShadowRay = std::function<Ray(const Ray& ray, const Hit& hit)>;

/// Traces all samples of the tile, band by band, and hands each pixel's samples to `shade`. Without
/// `shadow_ray` no shadow is hit. What is glass casts none.
void renderTile(const TraceRays& trace, const TraceGlass& glass, const Tile& tile,
                const SampleRay& sample_ray, const ShadowRay& shadow_ray, const ShadePixel& shade);

}  // namespace sightline
