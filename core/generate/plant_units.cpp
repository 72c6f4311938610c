#include "core/generate/plant_units.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/generate/generator_random.h"

namespace sightline {
namespace {

uint32_t unitSides(uint32_t level, uint32_t most = 128) {
  return std::min(most, 6 + 2 * level);
}

/// A dome over a cylinder: from (radius, y) to the pole `rise` higher (lower, if negative).
void addDome(std::vector<LathePoint>& profile, float radius, float y, float rise, uint32_t rings) {
  for (uint32_t i = 1; i <= rings; ++i) {
    const Turn t = turn(0.25f * float(i) / float(rings));
    profile.push_back({i == rings ? 0 : radius * t.cos, y + rise * t.sin});
  }
}

std::vector<LathePoint> vesselProfile(float radius, float low, float high, float dome, uint32_t level) {
  const uint32_t rings = 2 + level / 4, courses = 1 + level / 3;
  std::vector<LathePoint> profile;
  addDome(profile, radius, low, -dome, rings);
  std::reverse(profile.begin(), profile.end());
  for (uint32_t i = 0; i <= courses; ++i) {
    profile.push_back({radius, low + (high - low) * float(i) / float(courses)});
  }
  addDome(profile, radius, high, dome, rings);
  return profile;
}

void ladder(MeshBuilder& mesh, glm::vec3 foot, float height, uint32_t level) {
  const uint32_t sides = std::min(16u, 3 + level / 4);
  for (const float z : {-0.22f, 0.22f}) {
    const glm::vec3 rail[] = {foot + glm::vec3(0, 0, z), foot + glm::vec3(0, height, z)};
    mesh.tube(rail, 0.025f, sides, true);
  }
  const uint32_t rungs = uint32_t(height / 0.3f);
  for (uint32_t i = 0; i < rungs; ++i) {
    const float y = 0.3f * (float(i) + 0.5f);
    const glm::vec3 rung[] = {foot + glm::vec3(0, y, -0.22f), foot + glm::vec3(0, y, 0.22f)};
    mesh.tube(rung, 0.012f, sides, false);
  }
}

}  // namespace

void makeBeam(MeshBuilder& mesh, float length, float size, uint32_t level) {
  const float h = size / 2, web = size * 0.05f, flange = size * 0.09f;
  if (level < 3) {
    mesh.box({-h, -h, 0}, {h, h, length});
    return;
  }
  const glm::vec2 profile[12] = {
      {-h, -h}, {h, -h}, {h, -h + flange}, {web, -h + flange}, {web, h - flange},   {h, h - flange},
      {h, h},   {-h, h}, {-h, h - flange}, {-web, h - flange}, {-web, -h + flange}, {-h, -h + flange}};
  mesh.sheet(12, 1, true, [&](uint32_t i, uint32_t j) {
    return glm::vec3(profile[i].x, profile[i].y, j == 0 ? 0.0f : length);
  });
  if (level < 7) return;
  // Stiffeners in the web.
  const uint32_t plates = std::min(40u, (level - 5) / 2);
  for (uint32_t i = 0; i < plates; ++i) {
    const float z = length * (float(i) + 0.5f) / float(plates);
    for (const float s : {-1.0f, 1.0f}) {
      const float x0 = std::min(s * web, s * h * 0.95f), x1 = std::max(s * web, s * h * 0.95f);
      mesh.box({x0, -h + flange, z - web}, {x1, h - flange, z + web}, kNoLowY | kNoHighY);
    }
  }
}

void makeGrating(MeshBuilder& mesh, float width, float depth, uint32_t level) {
  if (level < 2) {
    mesh.box({0, -0.05f, 0}, {width, 0, depth});
    return;
  }
  const uint32_t bars = std::min(uint32_t(depth / 0.045f), 8 * (level - 1) + 4);
  const float pitch = depth / float(bars), thick = std::min(0.02f, pitch * 0.25f);
  for (uint32_t i = 0; i < bars; ++i) {
    const float z = pitch * (float(i) + 0.5f);
    mesh.box({0, -0.05f, z - thick}, {width, 0, z + thick});
  }
  const uint32_t cross = std::max(2u, bars / 4);
  for (uint32_t i = 0; i < cross; ++i) {
    const float x = width * (float(i) + 0.5f) / float(cross);
    mesh.box({x - 0.01f, -0.06f, 0}, {x + 0.01f, -0.035f, depth});
  }
}

void makeRailing(MeshBuilder& mesh, float length, uint32_t level) {
  if (level < 2) return;
  const uint32_t sides = std::min(24u, 3 + level / 3);
  for (const float y : {0.55f, 1.05f}) {
    const glm::vec3 rail[] = {{0, y, 0}, {length, y, 0}};
    mesh.tube(rail, 0.024f, sides, true);
  }
  const uint32_t posts = std::max(2u, uint32_t(length / 1.5f) + 1);
  for (uint32_t i = 0; i < posts; ++i) {
    const float x = 0.03f + (length - 0.06f) * float(i) / float(posts - 1);
    const glm::vec3 post[] = {{x, 0, 0}, {x, 1.05f, 0}};
    mesh.tube(post, 0.022f, sides, false);
  }
  mesh.box({0, 0, -0.005f}, {length, 0.1f, 0.005f});
}

void makeTank(MeshBuilder& mesh, float radius, float height, uint64_t seed, uint32_t level) {
  GeneratorRandom random(seed, 0x7a2c);
  const float dome = radius * 0.35f, low = 0.7f + dome, high = height - dome;
  mesh.lathe(vesselProfile(radius, low, high, dome, level), unitSides(level));
  const float leg = radius * 0.72f;
  for (uint32_t i = 0; i < 4; ++i) {
    const float x = i & 1 ? leg : -leg, z = i & 2 ? leg : -leg;
    mesh.box({x - 0.09f, 0, z - 0.09f}, {x + 0.09f, low + 0.3f, z + 0.09f}, kNoLowY);
  }
  if (level < 3) return;
  const Frame base = mesh.frame;
  const uint32_t nozzles = 3 + random.below(5), sides = std::min(48u, 4 + level);
  for (uint32_t i = 0; i < nozzles; ++i) {
    const float turned = random.unit();
    mesh.frame = base.at({0, random.uniform(low, high), 0}, turned);
    const float r = random.uniform(0.06f, 0.2f), out = radius + random.uniform(0.15f, 0.3f);
    const glm::vec3 pipe[] = {{radius - 0.05f, 0, 0}, {out, 0, 0}};
    mesh.tube(pipe, r, sides, false);
    const glm::vec3 plate[] = {{out, 0, 0}, {out + 0.05f, 0, 0}};
    mesh.tube(plate, r * 1.5f, sides, true);
  }
  mesh.frame = base;
  if (level < 4) return;
  // Hoops around the shell, and a ladder.
  const uint32_t hoops = std::min(30u, 1 + level / 3);
  for (uint32_t i = 0; i < hoops; ++i) {
    const float y = low + (high - low) * (float(i) + 0.5f) / float(hoops);
    const LathePoint hoop[] = {
        {radius, y - 0.03f}, {radius + 0.04f, y - 0.03f}, {radius + 0.04f, y + 0.03f}, {radius, y + 0.03f}};
    mesh.lathe(hoop, unitSides(level));
  }
  ladder(mesh, {radius + 0.25f, 0, 0}, height * 0.95f, level);
}

void makeDrum(MeshBuilder& mesh, float radius, float length, uint32_t level) {
  const Frame base = mesh.frame;
  // The lathe turns about y: lay that axis along x.
  mesh.frame = {base.point({0, radius + 0.6f, 0}), -base.y, base.x, base.z};
  const float half = length / 2 - radius * 0.4f;
  mesh.lathe(vesselProfile(radius, -half, half, radius * 0.4f, level), unitSides(level));
  mesh.frame = base;
  for (const float x : {-half * 0.7f, half * 0.7f}) {
    mesh.box({x - 0.15f, 0, -radius * 0.8f}, {x + 0.15f, 0.6f + radius * 0.3f, radius * 0.8f}, kNoLowY);
  }
  if (level < 4) return;
  const float r = radius * 0.3f, top = 2 * radius + 0.6f;
  const LathePoint manhole[] = {{r, top - radius * 0.2f},
                                {r, top + 0.2f},
                                {r * 1.2f, top + 0.2f},
                                {r * 1.2f, top + 0.28f},
                                {0, top + 0.28f}};
  mesh.lathe(manhole, unitSides(level, 64));
}

void makeTubeBank(MeshBuilder& mesh, glm::vec3 size, uint32_t level) {
  if (level == 0) {
    mesh.box({0, 0.3f, 0}, size);
    return;
  }
  const float header = std::min(0.5f, size.x * 0.1f);
  mesh.box({0, 0.3f, 0}, {header, size.y, size.z});
  mesh.box({size.x - header, 0.3f, 0}, size);
  const uint32_t rows = std::min(40u, 2 + level), columns = std::min(20u, 1 + level / 2);
  const uint32_t sides = std::min(24u, 3 + level / 3);
  const float dy = (size.y - 0.5f) / float(rows), dz = size.z / float(columns);
  const float r = std::min(dy, dz) * 0.33f;
  for (uint32_t i = 0; i < rows; ++i) {
    for (uint32_t k = 0; k < columns; ++k) {
      const float y = 0.4f + dy * (float(i) + 0.5f), z = dz * (float(k) + 0.5f);
      const glm::vec3 tube[] = {{header, y, z}, {size.x - header, y, z}};
      mesh.tube(tube, r, sides, false);
    }
  }
}

void makePump(MeshBuilder& mesh, uint32_t level) {
  if (level == 0) return;
  mesh.box({-0.8f, 0, -0.35f}, {0.8f, 0.25f, 0.35f}, kNoLowY);
  if (level < 2) {
    mesh.box({-0.7f, 0.25f, -0.25f}, {0.7f, 0.75f, 0.25f}, kNoLowY);
    return;
  }
  const Frame base = mesh.frame;
  mesh.frame = {base.point({0, 0.55f, 0}), -base.y, base.x, base.z};
  const uint32_t sides = unitSides(level, 64);
  const LathePoint motor[] = {{0, -0.72f},    {0.22f, -0.7f}, {0.25f, -0.6f}, {0.25f, -0.05f}, {0.2f, 0},
                              {0.06f, 0.01f}, {0.06f, 0.25f}, {0.2f, 0.26f},  {0.3f, 0.32f},   {0.3f, 0.5f},
                              {0.14f, 0.55f}, {0.14f, 0.75f}, {0, 0.75f}};
  mesh.lathe(motor, sides);
  mesh.frame = base;
  const glm::vec3 outlet[] = {{0.41f, 0.75f, 0}, {0.41f, 1.2f, 0}};
  mesh.tube(outlet, 0.1f, sides, true);
  const uint32_t fins = level < 6 ? 0 : std::min(48u, 2 * level);
  for (uint32_t i = 0; i < fins; ++i) {
    const float x = -0.58f + 0.5f * float(i) / float(fins);
    const float t = 0.2f / float(fins);
    mesh.box({x, 0.28f, -0.27f}, {x + t, 0.82f, 0.27f});
  }
}

void makeStair(MeshBuilder& mesh, float width, float run, float rise, uint32_t level) {
  const auto stringer = [&](float x) {
    const glm::vec3 along(0, rise, run);
    const glm::vec3 up(0, 0.25f, 0);
    mesh.quad({x, 0, 0}, glm::vec3(x, 0, 0) + along, glm::vec3(x, 0, 0) + along + up,
              glm::vec3(x, 0, 0) + up);
    const float y = x + 0.04f;
    mesh.quad(glm::vec3(y, 0, 0) + up, glm::vec3(y, 0, 0) + along + up, glm::vec3(y, 0, 0) + along,
              {y, 0, 0});
  };
  if (level == 0) {
    mesh.quad({0, 0, 0}, {0, rise, run}, {width, rise, run}, {width, 0, 0});
    return;
  }
  stringer(0);
  stringer(width - 0.04f);
  const uint32_t steps = std::max(2u, uint32_t(rise / 0.2f));
  const Frame base = mesh.frame;
  for (uint32_t i = 0; i < steps; ++i) {
    const float y = rise * float(i + 1) / float(steps), z = run * float(i) / float(steps);
    mesh.frame = base.at({0.05f, y, z});
    makeGrating(mesh, width - 0.1f, run / float(steps) * 0.95f, level < 8 ? 0 : std::min(3u, level / 6));
  }
  mesh.frame = base;
}

void makeCableTray(MeshBuilder& mesh, float length, uint32_t level) {
  if (level < 2) return;
  for (const float x : {-0.25f, 0.23f}) mesh.box({x, 0, 0}, {x + 0.02f, 0.1f, length});
  const uint32_t rungs = std::min(uint32_t(length / 0.1f), 4 * level);
  for (uint32_t i = 0; i < rungs; ++i) {
    const float z = length * (float(i) + 0.5f) / float(rungs);
    mesh.box({-0.23f, 0.005f, z - 0.015f}, {0.23f, 0.025f, z + 0.015f}, kNoLowX | kNoHighX);
  }
  const uint32_t cables = level < 5 ? 0 : std::min(10u, level - 3), sides = std::min(16u, 3 + level / 4);
  for (uint32_t i = 0; i < cables; ++i) {
    const float x = -0.2f + 0.4f * (float(i) + 0.5f) / float(cables);
    const uint32_t bends = std::min(40u, 1 + level);
    std::vector<glm::vec3> path;
    for (uint32_t k = 0; k <= bends; ++k) {
      const float wave = (k + i) % 3 == 0 ? 0.008f : 0.0f;
      path.push_back({x + wave, 0.045f + wave, length * float(k) / float(bends)});
    }
    mesh.tube(path, 0.012f, sides, false);
  }
}

}  // namespace sightline
