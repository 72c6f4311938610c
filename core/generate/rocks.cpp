#include "core/generate/rocks.h"

#include <algorithm>
#include <cmath>

#include "core/generate/generator_random.h"
#include "core/generate/noise.h"

namespace sightline {
namespace {

/// Rings of `sides` points upwards, closed by a fan at the top. point(i, j): i around, clockwise seen from
/// above, j up.
template <class Point>
void rings(MeshBuilder& mesh, uint32_t sides, uint32_t count, glm::vec3 top, Point&& point) {
  const uint32_t first = uint32_t(mesh.vertexCount());
  mesh.sheet(sides, count, true, point);
  const uint32_t last = first + sides * count, peak = mesh.vertex(top);
  for (uint32_t i = 0; i < sides; ++i) mesh.triangle(last + i, last + (i + 1) % sides, peak);
}

/// Where noise is looked up for a rock: another place for each.
glm::vec3 noiseOffset(uint64_t seed) {
  GeneratorRandom random(seed, 0x20c);
  return {random.uniform(0, 500), random.uniform(0, 500), random.uniform(0, 500)};
}

glm::vec3 around(uint32_t i, uint32_t sides) {
  const Turn t = turn(-float(i) / float(sides));
  return {t.cos, 0, t.sin};
}

}  // namespace

void makeBoulder(MeshBuilder& mesh, float radius, uint64_t seed, uint32_t level) {
  if (level == 0) return;
  const uint32_t sides = 3 + level, count = 1 + level / 2;
  const glm::vec3 offset = noiseOffset(seed);
  const auto at = [&](glm::vec3 direction) {
    const float bumps = 1 + 0.3f * fractal3(direction * 1.3f + offset, 4, seed);
    return direction * glm::vec3(1.2f, 0.8f, 1) * (radius * std::max(0.4f, bumps)) +
           glm::vec3(0, 0.3f * radius, 0);
  };
  rings(mesh, sides, count, at({0, 1, 0}), [&](uint32_t i, uint32_t j) {
    // From 126 degrees off the top (in the ground) to nearly the top.
    const Turn polar = turn(0.35f - 0.35f * float(j) / float(count + 1));
    return at(around(i, sides) * polar.sin + glm::vec3(0, polar.cos, 0));
  });
}

void makeHoodoo(MeshBuilder& mesh, float height, uint64_t seed, uint32_t level) {
  if (level == 0) return;
  const uint32_t sides = 4 + level, count = 5 + level;
  const glm::vec3 offset = noiseOffset(seed);
  const auto outline = [&](float s) {
    // Foot, neck at two thirds, cap above it.
    if (s < 0.68f) return 0.2f - 0.13f * std::sqrt(std::max(0.0f, s) / 0.68f);
    if (s < 0.74f) return 0.07f + 0.1f * (s - 0.68f) / 0.06f;
    const float c = (s - 0.74f) / 0.26f;
    return 0.17f * std::sqrt(std::max(0.04f, 1 - c * c));
  };
  rings(mesh, sides, count, {0, height * 1.02f, 0}, [&](uint32_t i, uint32_t j) {
    const float s = float(j) / float(count);
    const glm::vec3 p = around(i, sides) * outline(s) + glm::vec3(0, s * 1.06f - 0.06f, 0);
    const float bumps = 1 + 0.2f * fractal3(p * 7.0f + offset, 3, seed) + 0.08f * noise1(s * 24, seed + 9);
    return glm::vec3(p.x * bumps, p.y, p.z * bumps) * height;
  });
}

void makeRockArch(MeshBuilder& mesh, const RockArch& arch, uint32_t level) {
  if (level == 0) return;
  const uint32_t sides = 3 + level, count = 4 + 2 * level;
  const glm::vec3 offset = noiseOffset(arch.seed);
  mesh.sheet(sides, count, true, [&](uint32_t i, uint32_t j) {
    const float s = (2 * float(j) / float(count) - 1) * 1.2f;
    const glm::vec3 center(s * arch.half_span, arch.rise * (1 - s * s), 0);
    const glm::vec3 slope(arch.half_span, -2 * s * arch.rise, 0);
    const glm::vec3 along = slope / std::sqrt(glm::dot(slope, slope));
    const glm::vec3 up(-along.y, along.x, 0);
    const Turn t = turn(float(i) / float(sides));
    const glm::vec3 out = up * t.cos + glm::vec3(0, 0, t.sin);
    const glm::vec3 place = center / arch.half_span * 4.0f + out * 0.7f + offset;
    const float thickness = arch.radius * (0.8f + 0.7f * s * s) * (1 + 0.3f * fractal3(place, 4, arch.seed));
    return center + out * thickness;
  });
}

}  // namespace sightline
