#include "core/generate/plant_pipes.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr float kLattice = 0.35f;  // metres between the planes that pipes run in

bool segmentMeets(glm::vec3 a, glm::vec3 b, const PipeBox& box, float margin) {
  for (int i = 0; i < 3; ++i) {
    if (std::min(a[i], b[i]) > box.high[i] + margin || std::max(a[i], b[i]) < box.low[i] - margin)
      return false;
  }
  return box.low.x <= box.high.x;
}

float snap(float v, float low, float high) {
  return std::clamp(low + kLattice * std::floor((v - low) / kLattice + 0.5f), low, high);
}

/// The bend at b, from a towards c: a quarter circle about the corner in `steps` pieces.
void addBend(std::vector<glm::vec3>& path, glm::vec3 a, glm::vec3 b, glm::vec3 c, float bend,
             uint32_t steps) {
  const glm::vec3 in = unitVector(b - a), out = unitVector(c - b);
  const glm::vec3 center = b + (out - in) * bend;
  for (uint32_t i = 0; i <= steps; ++i) {
    const Turn t = turn(0.25f * float(i) / float(steps));
    path.push_back(center - out * (bend * t.cos) + in * (bend * t.sin));
  }
}

void flange(MeshBuilder& mesh, glm::vec3 at, glm::vec3 along, float radius, uint32_t sides, uint32_t bolts) {
  const float thickness = radius * 0.25f;
  const glm::vec3 path[] = {at - along * thickness, at + along * thickness};
  mesh.tube(path, radius * 1.6f, sides, true);
  const glm::vec3 side = std::fabs(along.y) < 0.5f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 up = glm::cross(along, side);
  for (uint32_t i = 0; i < bolts; ++i) {
    const Turn t = turn((float(i) + 0.5f) / float(bolts));
    const glm::vec3 p = at + (side * t.cos + up * t.sin) * (radius * 1.32f);
    const glm::vec3 bolt[] = {p - along * (thickness * 1.6f), p + along * (thickness * 1.6f)};
    mesh.tube(bolt, radius * 0.12f, 6, true);
  }
}

}  // namespace

std::vector<glm::vec3> routePipe(GeneratorRandom& random, const PipeBox& room, const PipeBox& obstacle,
                                 float radius, uint32_t legs) {
  const glm::vec3 low = room.low + 1.7f * radius, high = room.high - 1.7f * radius;
  const auto anywhere = [&](int axis) {
    return snap(random.uniform(low[axis], high[axis]), low[axis], high[axis]);
  };
  std::vector<glm::vec3> corners;
  for (uint32_t attempt = 0; corners.size() < 3; ++attempt) {
    corners.assign(1, {anywhere(0), anywhere(1), anywhere(2)});
    // After many failures the obstacle is too large for the room: go through it.
    const bool free = attempt > 50;
    int axis = int(random.below(3));
    for (uint32_t tries = 0; corners.size() <= legs && tries < 8 * legs; ++tries) {
      glm::vec3 next = corners.back();
      next[axis] = anywhere(axis);
      const bool too_short = std::fabs(next[axis] - corners.back()[axis]) < std::max(4 * radius, 0.6f);
      if (too_short || (!free && segmentMeets(corners.back(), next, obstacle, 1.7f * radius))) continue;
      corners.push_back(next);
      axis = (axis + 1 + int(random.below(2))) % 3;
    }
  }
  return corners;
}

void makePipe(MeshBuilder& mesh, const std::vector<glm::vec3>& corners, float radius, uint32_t level) {
  if (level == 0) return;
  const uint32_t sides = std::min(64u, 3 + level), steps = std::min(24u, level / 2);
  const float bend = std::min(1.8f * radius, 0.28f);
  std::vector<glm::vec3> path{corners.front()};
  for (size_t i = 1; i + 1 < corners.size(); ++i) {
    if (steps == 0) {
      path.push_back(corners[i]);
    } else {
      addBend(path, corners[i - 1], corners[i], corners[i + 1], bend, steps);
    }
  }
  path.push_back(corners.back());
  mesh.tube(path, radius, sides, true);
  if (level < 5) return;
  const uint32_t bolts = level < 9 ? 0 : std::min(16u, level - 3);
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    const glm::vec3 along = unitVector(corners[i + 1] - corners[i]);
    flange(mesh, (corners[i] + corners[i + 1]) * 0.5f, along, radius, sides, bolts);
  }
}

void makeValve(MeshBuilder& mesh, float radius, uint32_t level) {
  if (level < 2) return;
  const uint32_t sides = std::min(48u, 4 + level);
  const Frame base = mesh.frame;
  const LathePoint body[] = {{0, -1.5f * radius},         {1.5f * radius, -radius},
                             {1.6f * radius, radius},     {0.5f * radius, 1.6f * radius},
                             {0.5f * radius, 3 * radius}, {0, 3 * radius}};
  mesh.lathe(body, sides);
  for (const float x : {-2.0f, 2.0f}) {
    const uint32_t bolts = level < 9 ? 0 : std::min(16u, level - 3);
    flange(mesh, {x * radius, 0, 0}, {1, 0, 0}, radius, sides, bolts);
  }
  const float spindle = 0.12f * radius + 0.008f, top = 5 * radius + 0.1f, wheel = 1.5f * radius + 0.06f;
  const glm::vec3 stem[] = {{0, 3 * radius, 0}, {0, top, 0}};
  mesh.tube(stem, spindle, std::max(4u, sides / 2), true);
  // The wheel: a ring, as a sheet around its circle and around its section, and spokes.
  const uint32_t around = std::min(96u, 6 + 2 * level), section = std::min(32u, 3 + level / 3);
  const uint32_t first = uint32_t(mesh.vertexCount());
  for (uint32_t i = 0; i < around; ++i) {
    const Turn t = turn(float(i) / float(around));
    for (uint32_t k = 0; k < section; ++k) {
      const Turn s = turn(float(k) / float(section));
      const float r = wheel + spindle * s.cos;
      mesh.vertex({r * t.cos, top + spindle * s.sin, r * t.sin});
    }
  }
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t k = 0; k < section; ++k) {
      const uint32_t i2 = (i + 1) % around * section, k2 = (k + 1) % section;
      mesh.quad(first + i * section + k, first + i * section + k2, first + i2 + k2, first + i2 + k);
    }
  }
  for (uint32_t i = 0; i < 4; ++i) {
    const Turn t = turn(0.25f * float(i) + 0.1f);
    const glm::vec3 spoke[] = {{0, top, 0}, {wheel * t.cos, top, wheel * t.sin}};
    mesh.tube(spoke, spindle * 0.6f, std::max(3u, sides / 3), false);
  }
  mesh.frame = base;
}

}  // namespace sightline
