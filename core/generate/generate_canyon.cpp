// A canyon: a sheet of terrain with overhanging cliffs (canyon_terrain.h), bridges of rock across it, and
// rocks.h on floor, ledges and plateau. Free space for cells: above the river, within kCanyonFreeLane.
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/cell/rotation.h"
#include "core/generate/canyon_terrain.h"
#include "core/generate/generator_random.h"
#include "core/generate/rocks.h"
#include "core/generate/scene_generators.h"
#include "core/generate/walk_plan.h"

namespace sightline {
namespace {

using Terrain = std::shared_ptr<const CanyonTerrain>;

constexpr uint32_t kTile = 64;            // quads along a tile of terrain, each an object
constexpr float kCanyonFreeLane = 0.12f;  // half width without rocks, share of the canyon's
constexpr double kTerrainShare = 0.62;    // of the triangles

Terrain makeTerrain(uint64_t triangles, uint64_t seed) {
  // An extent that grows with the fourth root: half of the growth is area, half is detail.
  return std::make_shared<CanyonTerrain>(71.0f * std::sqrt(std::sqrt(float(triangles))), seed);
}

/// The map's columns are even in x. Its rows crowd along the river: v in [-1, 1] from edge to edge.
glm::vec2 mapPoint(const CanyonTerrain& terrain, float u, float v) {
  const float half = terrain.extent() / 2;
  const float river = terrain.riverZ(u * half), a = std::fabs(v);
  const float s = 0.4f * a + 0.6f * a * a * a;
  return {u * half, v < 0 ? river - s * (half + river) : river + s * (half - river)};
}

void addTerrain(std::vector<ScenePart>& parts, const Terrain& terrain, uint64_t triangles) {
  const uint32_t n = uint32_t(std::sqrt(double(triangles) * kTerrainShare / 2)) & ~1u;  // a row on the river
  for (uint32_t i = 0; i < n; i += kTile) {
    for (uint32_t j = 0; j < n; j += kTile) {
      const uint32_t nu = std::min(kTile, n - i), nv = std::min(kTile, n - j);
      parts.push_back({"terrain-" + std::to_string(i / kTile) + "-" + std::to_string(j / kTile),
                       [=](MeshBuilder& mesh, uint32_t) {
                         // From high to low z, so that the faces look up.
                         mesh.sheet(nu, nv, false, [&](uint32_t a, uint32_t b) {
                           const float u = 2 * float(i + a) / float(n) - 1;
                           const float v = 1 - 2 * float(j + b) / float(n);
                           return terrain->surface(mapPoint(*terrain, u, v));
                         });
                       },
                       0});
    }
  }
}

void addRock(std::vector<ScenePart>& parts, const Terrain& terrain, uint32_t index, uint64_t seed) {
  GeneratorRandom random(seed, 0x20c5, index);
  const float w = terrain->width();
  glm::vec2 at;
  float t;
  uint32_t tries = 0;
  do {
    const float across = random.uniform(-0.9f, 0.9f), along = random.uniform(-0.95f, 0.95f);
    at = mapPoint(*terrain, along, across);
    t = terrain->steepness(at);
  } while (t < kCanyonFreeLane + 0.04f && ++tries < 100);
  if (tries == 100) at = mapPoint(*terrain, random.uniform(-0.95f, 0.95f), 0.8f);
  const uint64_t own = random.next();
  const float kind = random.unit(), size = random.unit();
  Frame frame;
  frame.origin = {at.x, terrain->height(at), at.y};
  frame = frame.at({0, 0, 0}, random.unit());
  const auto add = [&](const char* name, auto make) {
    parts.push_back({name + std::to_string(index),
                     [=](MeshBuilder& mesh, uint32_t level) {
                       mesh.frame = frame;
                       make(mesh, level);
                     },
                     kRockLevels});
  };
  if (t > 0.45f && kind < 0.3f) {
    const float high = w * (0.04f + 0.08f * size * size);
    add("hoodoo-", [=](MeshBuilder& mesh, uint32_t level) { makeHoodoo(mesh, high, own, level); });
  } else if (t > 0.45f && t < 1.8f && kind < 0.45f) {
    const RockArch arch{w * (0.05f + 0.07f * size), w * (0.06f + 0.06f * size), w * 0.02f, own};
    add("arch-", [=](MeshBuilder& mesh, uint32_t level) { makeRockArch(mesh, arch, level); });
  } else {
    const float radius = w * (0.004f + 0.016f * size * size);
    add("boulder-", [=](MeshBuilder& mesh, uint32_t level) { makeBoulder(mesh, radius, own, level); });
  }
}

void addBridges(std::vector<ScenePart>& parts, const Terrain& terrain, uint64_t seed) {
  const uint32_t count = 1 + uint32_t(terrain->extent() / 1500);
  for (uint32_t i = 0; i < count; ++i) {
    GeneratorRandom random(seed, 0xb21d6e, i);
    const float x = terrain->extent() * ((float(i) + random.uniform(0.4f, 0.6f)) / float(count) - 0.5f);
    const RockArch arch{terrain->width() * 1.05f, terrain->depth() * 0.25f, terrain->width() * 0.07f,
                        random.next()};
    Frame frame;
    frame.origin = {x, terrain->depth() * 0.6f, terrain->riverZ(x)};
    frame = frame.at({0, 0, 0}, 0.25f);
    parts.push_back({"bridge-" + std::to_string(i),
                     [=](MeshBuilder& mesh, uint32_t level) {
                       mesh.frame = frame;
                       makeRockArch(mesh, arch, level);
                     },
                     kRockLevels});
  }
}

/// A long, narrow box over the river near x, as long as the meander allows (at most `longest`).
ViewCell riverCell(const CanyonTerrain& terrain, const char* name, double x, double longest) {
  const double lane = kCanyonFreeLane * terrain.width();
  const double width = std::min(2.5, lane * 0.4), bottom = 0.02 * terrain.depth() + 0.5;
  for (double length = longest;; length *= 0.8) {
    const float x0 = float(x - length / 2), x1 = float(x + length / 2);
    const double z0 = terrain.riverZ(x0), z1 = terrain.riverZ(x1);
    double off = 0;
    for (int i = 1; i < 16; ++i) {
      const float s = float(i) / 16;
      off = std::max(off, std::fabs(double(terrain.riverZ(x0 + (x1 - x0) * s)) - (z0 + (z1 - z0) * s)));
    }
    if (off + width > lane * 0.7 && length > width * 2) continue;
    const double dx = x1 - x0, dz = z1 - z0, run = std::sqrt(dx * dx + dz * dz);
    return {name,
            {x, bottom + 1, (z0 + z1) / 2},
            {width, 2, std::min(length, run)},
            {0, atan2Degrees(dx, dz), 0}};
  }
}

}  // namespace

std::vector<ScenePart> canyonParts(uint64_t triangles, uint64_t seed) {
  const Terrain terrain = makeTerrain(triangles, seed);
  std::vector<ScenePart> parts;
  addTerrain(parts, terrain, triangles);
  addBridges(parts, terrain, seed);
  const uint32_t rocks = uint32_t(0.5f * std::sqrt(float(triangles)));
  for (uint32_t i = 0; i < rocks; ++i) addRock(parts, terrain, i, seed);
  return parts;
}

std::vector<ViewCell> canyonCells(uint64_t triangles, uint64_t seed) {
  const Terrain terrain = makeTerrain(triangles, seed);
  const double e = terrain->extent(), w = terrain->width(), d = terrain->depth();
  const auto river = [&](double share, double y) {
    return glm::dvec3(share * e, y, double(terrain->riverZ(float(share * e))));
  };
  const double longest = std::min(150.0, 0.25 * e);
  return {
      {"flat-1", river(-0.35, 0.2 * d), {0.1 * w, 0.08 * w, 0}, {0, 90, 0}},
      {"flat-2", river(0.38, 0.3 * d), {0.1 * w, 0.05 * w, 0}, {0, -97, 0}},
      {"flat-3", river(0.1, 1.8 * d), {0.25 * w, 0.1 * w, 0}, {35, 40, 0}},
      {"flat-4", river(-0.1, 2.2 * d), {0.2 * w, 0.2 * w, 0}, {90, 0, 0}},
      {"box-1", river(0.12, 0.25 * d), {0.1 * w, 0.1 * d, 0.1 * w}, {0, 0, 0}},
      {"box-2", river(-0.2, 1.9 * d) + glm::dvec3(0, 0, w), {0.5 * w, 0.3 * d, 0.5 * w}, {0, 20, 0}},
      {"box-3", river(0.22, 0.02 * d + 1.5), {2, 2, 2}, {0, 30, 0}},
      riverCell(*terrain, "street-1", -0.22 * e, longest),
      riverCell(*terrain, "street-2", 0.02 * e, longest),
      riverCell(*terrain, "street-3", 0.3 * e, longest / 2),
  };
}

CameraPath canyonWalk(uint64_t triangles, uint64_t seed, uint32_t frames) {
  const Terrain terrain = makeTerrain(triangles, seed);
  const double e = terrain->extent(), d = terrain->depth();
  const auto river = [&](double share, double y) {
    return glm::dvec3(share * e, y, double(terrain->riverZ(float(share * e))));
  };
  constexpr double kStep = 0.01, kAhead = 0.03;  // of the extent: the river's bends are longer
  const double eye = 0.02 * d + 1.5;
  WalkPlan plan(frames);
  const auto follow = [&](double from_share, double to_share, double from, double to) {
    const double steps = std::ceil(std::fabs(to - from) / kStep), ahead = to > from ? kAhead : -kAhead;
    for (double i = 0; i <= steps; ++i) {
      const double at = from + (to - from) * (i / steps);
      plan.key(from_share + (to_share - from_share) * (i / steps), river(at, eye), river(at + ahead, eye));
    }
  };
  follow(0, kTurnFrom, -0.42, -0.2);
  plan.turn(kTurnFrom, kTurnTo, river(-0.2, eye), 90, -270);
  follow(kTurnTo, kSecondTo, -0.2, 0);
  plan.cut(kSideFrom, river(0.4, eye), river(0.4 - kAhead, eye));
  follow(kSideFrom, kSideTo, 0.4, 0.2);
  plan.cut(kRiseFrom, river(0.1, 1.8 * d), river(0, d));
  plan.key(0.78, river(0.1, 2.2 * d), river(0, d));
  plan.seeAll({0, 0, 0}, e, {0, 0, 1});
  return plan.path();
}

}  // namespace sightline
