#include "core/generate/street_props.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/generate/generator_random.h"

namespace sightline {
namespace {

uint32_t streetSides(uint32_t level, uint32_t most = 48) {
  return std::min(most, 4 + level);
}

void wheel(MeshBuilder& mesh, glm::vec3 center, float width, float radius, uint32_t sides) {
  const glm::vec3 path[] = {center - glm::vec3(width / 2, 0, 0), center + glm::vec3(width / 2, 0, 0)};
  mesh.tube(path, radius, sides, true);
}

/// The car's body between two stations along z: outline from sill over the roof to sill.
struct Station {
  float z, half_width, low, high;
};

void loft(MeshBuilder& mesh, const std::vector<Station>& stations) {
  const uint32_t first = uint32_t(mesh.vertexCount());
  for (const Station& s : stations) {
    const float belt = s.low + (s.high - s.low) * 0.6f;
    mesh.vertex({s.half_width, s.low, s.z});
    mesh.vertex({s.half_width, belt, s.z});
    mesh.vertex({s.half_width * 0.8f, s.high, s.z});
    mesh.vertex({-s.half_width * 0.8f, s.high, s.z});
    mesh.vertex({-s.half_width, belt, s.z});
    mesh.vertex({-s.half_width, s.low, s.z});
  }
  const uint32_t last = first + uint32_t(stations.size() - 1) * 6;
  for (uint32_t k = first; k < last; k += 6) {
    for (uint32_t i = 0; i < 5; ++i) mesh.quad(k + i, k + i + 1, k + i + 7, k + i + 6);
  }
  for (uint32_t i = 1; i < 5; ++i) {
    mesh.triangle(first, first + i + 1, first + i);
    mesh.triangle(last, last + i, last + i + 1);
  }
}

}  // namespace

void makeCar(MeshBuilder& mesh, uint64_t seed, uint32_t level) {
  if (level < 2) return;
  GeneratorRandom random(seed, 0xca2);
  const float length = random.uniform(1.9f, 2.2f), half = random.uniform(0.82f, 0.92f);
  const float roof = random.uniform(1.4f, 1.6f), bonnet = random.uniform(0.85f, 1.0f);
  if (level < 4) {
    mesh.box({-half, 0.3f, -length}, {half, bonnet, length});
    mesh.box({-half * 0.85f, bonnet, -length * 0.6f}, {half * 0.85f, roof, length * 0.4f}, kNoLowY);
    return;
  }
  loft(mesh, {{-length, half * 0.9f, 0.35f, bonnet * 0.9f},
              {-length * 0.85f, half, 0.3f, bonnet},
              {-length * 0.55f, half, 0.3f, roof * 0.96f},
              {-length * 0.1f, half, 0.3f, roof},
              {length * 0.2f, half, 0.3f, roof * 0.97f},
              {length * 0.5f, half, 0.3f, bonnet},
              {length * 0.85f, half, 0.3f, bonnet * 0.92f},
              {length, half * 0.9f, 0.35f, bonnet * 0.8f}});
  for (const float x : {-half + 0.05f, half - 0.05f}) {
    for (const float z : {-length * 0.62f, length * 0.62f}) {
      wheel(mesh, {x, 0.32f, z}, 0.2f, 0.3f, streetSides(level + 4));
      if (level < 8) continue;
      const uint32_t spokes = std::min(24u, level - 3);
      const float out = x < 0 ? x - 0.1f : x + 0.1f;
      for (uint32_t i = 0; i < spokes; ++i) {
        const Turn t = turn(float(i) / float(spokes));
        mesh.box({out - 0.01f, 0.32f + 0.18f * t.sin - 0.02f, z + 0.18f * t.cos - 0.02f},
                 {out + 0.01f, 0.32f + 0.18f * t.sin + 0.02f, z + 0.18f * t.cos + 0.02f});
      }
    }
  }
  if (level < 6) return;
  for (const float s : {-1.0f, 1.0f}) {
    const float x = s * (half + 0.06f);
    mesh.box({x - 0.06f, 0.98f, length * 0.3f}, {x + 0.06f, 1.1f, length * 0.3f + 0.08f});
    mesh.box({s * half * 0.6f - 0.12f, 0.6f, length - 0.03f},
             {s * half * 0.6f + 0.12f, 0.72f, length + 0.04f});
  }
  mesh.box({-half * 0.9f, 0.36f, length - 0.02f}, {half * 0.9f, 0.5f, length + 0.08f});
  mesh.box({-half * 0.9f, 0.36f, -length - 0.08f}, {half * 0.9f, 0.5f, -length + 0.02f});
}

void makeLamp(MeshBuilder& mesh, uint64_t seed, uint32_t level) {
  if (level < 2) return;
  GeneratorRandom random(seed, 0x1a3);
  const float high = random.uniform(5.0f, 5.8f);
  if (level < 4) {
    mesh.box({-0.06f, 0, -0.06f}, {0.06f, high, 0.06f}, kNoLowY);
    mesh.box({-0.1f, high, -0.15f}, {1.2f, high + 0.12f, 0.15f});
    return;
  }
  const uint32_t sides = streetSides(level);
  const LathePoint pole[] = {{0.16f, 0}, {0.16f, 0.5f}, {0.07f, 0.7f}, {0.05f, high}, {0, high + 0.1f}};
  mesh.lathe(pole, sides);
  std::vector<glm::vec3> arm;
  const uint32_t steps = std::min(24u, level);
  for (uint32_t i = 0; i <= steps; ++i) {
    const Turn t = turn(0.25f * float(i) / float(steps));
    arm.push_back({1.1f * t.sin, high - 0.6f + 0.6f * (1 - t.cos) + 0.2f * t.sin, 0});
  }
  mesh.tube(arm, 0.03f, std::max(3u, sides / 2), false);
  const Frame base = mesh.frame;
  mesh.frame = base.at(arm.back());
  const LathePoint head[] = {{0, -0.22f}, {0.16f, -0.16f}, {0.22f, 0}, {0.1f, 0.08f}, {0, 0.12f}};
  mesh.lathe(head, sides);
  mesh.frame = base;
}

void makeTree(MeshBuilder& mesh, uint64_t seed, uint32_t level) {
  if (level < (mesh.alpha() ? 1u : 2u)) return;  // cards are cheap
  GeneratorRandom random(seed, 0x73ee);
  const float trunk = random.uniform(2.5f, 3.1f), crown = random.uniform(1.25f, 1.6f);
  const float high = random.uniform(1.3f, 1.7f);
  const uint32_t sides = std::min(16u, 3 + level / 2);
  const float bend_z = random.uniform(-0.1f, 0.1f), bend_x = random.uniform(-0.1f, 0.1f);
  const glm::vec3 bend(bend_x, 0, bend_z);
  const glm::vec3 stem[] = {{0, 0, 0}, glm::vec3(0, trunk * 0.6f, 0) + bend, {0, trunk + high, 0}};
  const float radii[] = {0.16f, 0.11f, 0.03f};
  mesh.tube(stem, radii, sides, false);
  const glm::vec3 middle(0, trunk + high - 0.3f, 0);
  if (level < 5 && mesh.alpha()) {
    // Upright cards through the trunk.
    mesh.use(Matter::kLeaf);
    const uint32_t cards = std::max(2u, level);
    for (uint32_t i = 0; i < cards; ++i) {
      const Turn t = turn(0.5f * (float(i) + random.unit()) / float(cards));
      const glm::vec3 out = glm::vec3(t.cos, 0, t.sin) * crown, up(0, 1.2f * high, 0);
      mesh.quad(middle - out - up, middle + out - up, middle + out + up, middle - out + up);
    }
    return;
  }
  if (level < 5) {
    const Frame base = mesh.frame;
    mesh.frame = base.at(middle);
    const LathePoint ball[] = {
        {0, -high * 0.8f}, {crown * 0.9f, -high * 0.3f}, {crown * 0.8f, high * 0.4f}, {0, high}};
    mesh.lathe(ball, 4 + level);
    mesh.frame = base;
    return;
  }
  const uint32_t branches = std::min(40u, level - 2);
  for (uint32_t i = 0; i < branches; ++i) {
    const Turn t = turn(random.unit());
    const glm::vec3 from(0, trunk * random.uniform(0.85f, 1.3f), 0);
    const glm::vec3 out(t.cos * crown * 0.8f, high * random.uniform(0.1f, 0.7f), t.sin * crown * 0.8f);
    const glm::vec3 path[] = {from, from + out * 0.5f + glm::vec3(0, -0.1f, 0), from + out};
    const float thin[] = {0.05f, 0.03f, 0.012f};
    mesh.tube(path, thin, std::max(3u, sides / 2), false);
  }
  const uint32_t leaves = 14 * (level - 4) * (level - 4) + 60;
  // A card is larger than a leaf, for some of it is holes.
  const float size = std::max(0.06f, 3.2f / std::sqrt(float(leaves))) * (mesh.alpha() ? 1.6f : 1.0f);
  mesh.use(Matter::kLeaf);
  for (uint32_t i = 0; i < leaves; ++i) {
    // Uniform in a ball by rejection, pushed out: most leaves are near the surface.
    glm::vec3 p;
    float rr;
    do {
      p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      rr = glm::dot(p, p);
    } while (rr > 1 || rr < 0.1f);
    p *= (0.5f + 0.5f * rr) / std::sqrt(rr);
    const Turn t = turn(random.unit());
    const glm::vec3 u = glm::vec3(t.cos, random.uniform(-0.6f, 0.6f), t.sin) * size;
    const glm::vec3 v = glm::vec3(-t.sin * 0.3f, random.uniform(0.4f, 0.8f), t.cos * 0.3f) * size;
    const glm::vec3 c = middle + p * glm::vec3(crown - 0.1f, high - 0.1f, crown - 0.1f);
    mesh.quad(c - u * 0.5f, c - v * 0.5f, c + u * 0.5f, c + v * 0.5f);
  }
}

void makeBin(MeshBuilder& mesh, uint64_t, uint32_t level) {
  if (level < 2) return;
  const LathePoint outline[] = {{0, 0.02f},    {0.22f, 0.02f}, {0.26f, 0.85f}, {0.28f, 0.87f},
                                {0.28f, 0.9f}, {0.24f, 0.9f},  {0.2f, 0.1f},   {0, 0.08f}};
  mesh.lathe(outline, streetSides(level));
}

void makeWire(MeshBuilder& mesh, glm::vec3 a, glm::vec3 b, uint32_t level) {
  if (level < 2) return;
  const uint32_t steps = std::min(40u, 2 * level);
  std::vector<glm::vec3> path;
  for (uint32_t i = 0; i <= steps; ++i) {
    const float s = float(i) / float(steps);
    path.push_back(a + (b - a) * s - glm::vec3(0, 2.4f * s * (1 - s), 0));
  }
  mesh.tube(path, 0.015f, 3, false);
  const Frame base = mesh.frame;
  mesh.frame = base.at((a + b) * 0.5f - glm::vec3(0, 0.6f, 0));
  const LathePoint lamp[] = {{0, -0.5f}, {0.2f, -0.4f}, {0.25f, -0.2f}, {0, 0}};
  mesh.lathe(lamp, streetSides(level, 32));
  mesh.frame = base;
}

}  // namespace sightline
