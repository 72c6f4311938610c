#include "core/picture/shading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/picture/picture.h"

namespace sightline {
namespace {

constexpr float kGamma = 2.2f;
constexpr float kGlassOpacity = 0.38f;       ///< of a pane seen straight on
constexpr uint64_t kBandSamples = 1u << 20;  ///< rays at once: 40 MiB with their hits, full launches

}  // namespace

void checkSize(uint32_t width, uint32_t height) {
  const auto fits = [](uint32_t side) { return side >= kMinPictureSide && side <= kMaxPictureSide; };
  if (fits(width) && fits(height)) return;
  throw Error(fmt::format("picture: {} x {} pixels: each side needs {} to {}", width, height, kMinPictureSide,
                          kMaxPictureSide),
              kExitUsage);
}

std::vector<uint8_t> membership(const Scene& scene, std::span<const uint32_t> triangles) {
  std::vector<uint8_t> member(scene.triangleCount(), 0);
  for (const uint32_t triangle : triangles) {
    if (triangle >= member.size()) {
      throw Error(
          fmt::format("picture: the set holds triangle {}, the scene has only {}", triangle, member.size()));
    }
    member[triangle] = 1;
  }
  return member;
}

glm::vec3 facingNormal(const Scene& scene, uint32_t triangle, glm::vec3 direction) {
  const auto corners = scene.corners(triangle);
  const glm::dvec3 a = corners[0], b = corners[1], c = corners[2];
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  if (!(length > 0)) return -direction;
  const glm::vec3 unit(normal / length);
  return glm::dot(unit, direction) > 0 ? -unit : unit;
}

float lightOn(glm::vec3 normal, glm::vec3 direction, glm::vec3 to_sun, float sunlit) {
  const glm::vec3 from_behind = glm::normalize(glm::vec3(-to_sun.x, 0.1f * to_sun.y, -0.5f * to_sun.z));
  const float sky = 0.27f + 0.14f * normal.y;
  const float sun = 0.9f * std::max(0.0f, glm::dot(normal, to_sun)) * sunlit;
  const float fill = 0.16f * std::max(0.0f, glm::dot(normal, from_behind));
  const float viewer = 0.12f * std::max(0.0f, -glm::dot(normal, direction));
  return sky + sun + fill + viewer;
}

glm::vec3 throughGlass(const Scene& scene, glm::vec3 behind, std::span<const SeenThrough> glass,
                       glm::vec3 direction, glm::vec3 to_sun,
                       const std::function<glm::vec3(uint32_t triangle)>& color) {
  float passes = 1, weights = 0;
  glm::vec3 panes(0);
  for (const SeenThrough& pane : glass) {
    const glm::vec3 normal = facingNormal(scene, pane.triangle, direction);
    const float slant = 1 - std::max(0.0f, -glm::dot(normal, direction));
    const float opacity = kGlassOpacity + (1 - kGlassOpacity) * 0.5f * slant * slant;
    passes *= 1 - opacity;
    panes += opacity * color(pane.triangle) * lightOn(normal, direction, to_sun, 1);
    weights += opacity;
  }
  return weights > 0 ? passes * behind + (1 - passes) * panes / weights : behind;
}

Ray makeRay(glm::vec3 origin, glm::vec3 direction) {
  return {glm::vec4(origin, 0), glm::vec4(direction, 0)};
}

Rgb encode(glm::vec3 linear) {
  const auto channel = [](float value) {
    return uint8_t(std::lround(255.0f * std::pow(std::clamp(value, 0.0f, 1.0f), 1.0f / kGamma)));
  };
  return {channel(linear.x), channel(linear.y), channel(linear.z)};
}

glm::vec3 decode(Rgb pixel) {
  const auto channel = [](uint8_t value) { return std::pow(float(value) / 255.0f, kGamma); };
  return {channel(pixel.red), channel(pixel.green), channel(pixel.blue)};
}

glm::vec3 skyColor(float height) {
  return glm::mix(glm::vec3(0.93f), glm::vec3(0.72f, 0.82f, 0.93f), height);
}

void renderTile(const TraceRays& trace, const TraceGlass& glass, const Tile& tile,
                const SampleRay& sample_ray, const ShadowRay& shadow_ray, const ShadePixel& shade) {
  constexpr uint32_t kPerPixel = kSamplesPerAxis * kSamplesPerAxis;
  const uint64_t row_samples = uint64_t(tile.width) * kPerPixel;
  const uint32_t band_rows = uint32_t(std::clamp<uint64_t>(kBandSamples / row_samples, 1, tile.height));
  std::vector<Ray> rays(band_rows * row_samples), shadow_rays;
  std::vector<Hit> hits(rays.size()), shadow_hits;
  std::vector<SeenThrough> seen;
  for (uint32_t first = 0; first < tile.height; first += band_rows) {
    const uint32_t rows = std::min(band_rows, tile.height - first);
    const size_t count = rows * row_samples;
    for (size_t i = 0; i < count; ++i) {  // the samples of a pixel lie side by side
      const uint32_t pixel = uint32_t(i / kPerPixel), sample = uint32_t(i % kPerPixel);
      rays[i] = sample_ray(pixel % tile.width * kSamplesPerAxis + sample % kSamplesPerAxis,
                           (first + pixel / tile.width) * kSamplesPerAxis + sample / kSamplesPerAxis);
    }
    trace(std::span(rays).first(count), std::span(hits).first(count));
    if (glass) seen = glass(std::span(rays).first(count), std::span(hits).first(count));
    if (shadow_ray) {
      shadow_rays.resize(count);
      shadow_hits.resize(count);
      for (size_t i = 0; i < count; ++i) {
        shadow_rays[i] = hits[i].triangle == kNoTriangle ? makeRay({}, {}) : shadow_ray(rays[i], hits[i]);
      }
      trace(shadow_rays, shadow_hits);
    }
    auto pane = seen.cbegin();
    std::array<Sample, kPerPixel> samples;
    for (uint32_t pixel = 0; pixel < count / kPerPixel; ++pixel) {
      for (uint32_t s = 0; s < kPerPixel; ++s) {
        const size_t i = size_t(pixel) * kPerPixel + s;
        const auto begin = pane;
        while (pane != seen.cend() && pane->ray == i) ++pane;
        samples[s] = {rays[i], hits[i], shadow_ray ? shadow_hits[i] : Hit{0, kNoTriangle}, {begin, pane}};
      }
      shade(tile.x + pixel % tile.width, tile.y + first + pixel / tile.width, samples);
    }
  }
}

}  // namespace sightline
