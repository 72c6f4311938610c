#include "core/generate/canyon_terrain.h"

#include <algorithm>
#include <cmath>

#include "core/generate/generator_random.h"
#include "core/generate/noise.h"

namespace sightline {
namespace {

constexpr float kCliff = 0.3f;  // share of a step that is cliff; the rest is ledge

/// Smooth rise from 0 to 1.
float rise(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

}  // namespace

CanyonTerrain::CanyonTerrain(float extent, uint64_t seed)
    : extent_(extent),
      width_(24 + 0.1f * extent),
      depth_(20 + 0.075f * extent),
      steps_(extent < 600    ? 2
             : extent < 2000 ? 3
                             : 4),
      seed_(seed) {
  GeneratorRandom random(seed, 0xca27);
  const uint32_t sides = 2 + uint32_t(extent / 900);
  for (uint32_t i = 0; i < sides; ++i) {
    const float x = extent * ((float(i) + random.uniform(0.3f, 0.7f)) / float(sides) - 0.5f);
    sides_.push_back({x, random.chance(0.5f) ? 1.0f : -1.0f, extent * random.uniform(0.25f, 0.45f),
                      random.uniform(0, 100)});
  }
}

float CanyonTerrain::riverZ(float x) const {
  return extent_ *
         (0.07f * noise1(x / extent_ * 3.0f, seed_ + 11) + 0.02f * noise1(x / extent_ * 9.0f, seed_ + 12));
}

float CanyonTerrain::steepness(glm::vec2 xz) const {
  const float dz = xz.y - riverZ(xz.x);
  float t = std::fabs(dz) / width_;
  for (const Side& side : sides_) {
    const float along = dz * side.direction;
    if (along < 0 || along > side.reach) continue;
    const float bend =
        0.8f * width_ * noise1(along / width_ * 0.4f + side.phase, seed_ + 13) * rise(along / width_ - 0.5f);
    const float across = std::fabs(xz.x - side.x - bend) / (0.55f * width_);
    // The further from the river, the higher the floor of the side canyon.
    t = std::min(t, across + std::max(0.0f, along / side.reach - 0.3f));
  }
  // Walls wander by noise; the river bed does not, there is free space for view cells.
  const float wander = fractal2(xz / width_ * 1.7f, 3, seed_ + 14);
  return std::max(0.0f, t + 0.16f * wander * rise(t / kCanyonFloor - 0.5f));
}

float CanyonTerrain::heightAt(float t, glm::vec2 xz) const {
  const float rough = fractal2(xz / width_ * 6.0f, 5, seed_ + 15);
  const float wall = (t - kCanyonFloor) / (1 - kCanyonFloor);
  if (wall <= 0) return depth_ * 0.01f * rough;
  if (wall >= 1) {
    const float hills = fractal2(xz / width_ * 0.5f, 3, seed_ + 16);
    return depth_ * (1 + 0.012f * rough + 0.12f * (1 + 0.5f * hills) * rise((wall - 1) * 0.5f));
  }
  const float step = std::min(wall * float(steps_), float(steps_) - 1e-4f);
  const float base = std::floor(step), in = step - base;
  const float cliff = rise(in / kCliff) * 0.85f, ledge = std::max(0.0f, in - kCliff) / (1 - kCliff) * 0.15f;
  return depth_ * ((base + cliff + ledge) / float(steps_) + 0.01f * rough);
}

float CanyonTerrain::height(glm::vec2 xz) const {
  return heightAt(steepness(xz), xz);
}

glm::vec3 CanyonTerrain::surface(glm::vec2 xz) const {
  const float t = steepness(xz);
  const float wall = (t - kCanyonFloor) / (1 - kCanyonFloor);
  glm::vec2 at = xz;
  if (wall > 0 && wall < 1) {
    const float e = width_ * 0.01f;
    glm::vec2 out(steepness({xz.x + e, xz.y}) - steepness({xz.x - e, xz.y}),
                  steepness({xz.x, xz.y + e}) - steepness({xz.x, xz.y - e}));
    const float length = std::sqrt(glm::dot(out, out));
    if (length > 0) out /= length;
    // The foot of a cliff goes into the rock, its edge out over the foot; the ledge leads back.
    const float step = wall * float(steps_), in = step - std::floor(step);
    const float lean = in < kCliff ? 2 * rise(in / kCliff) - 1 : 1 - 2 * rise((in - kCliff) / (1 - kCliff));
    const float ends = std::min(rise(wall * float(steps_) * 8), rise((1 - wall) * float(steps_) * 3));
    const float strength = 0.6f + 0.4f * noise2(xz / width_ * 3.0f, seed_ + 17);
    at -= out * (lean * ends * strength * 0.3f * width_ * (1 - kCanyonFloor) / float(steps_));
  }
  return {at.x, heightAt(t, xz), at.y};
}

}  // namespace sightline
