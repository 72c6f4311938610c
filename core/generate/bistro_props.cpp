#include "core/generate/bistro_props.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/generate/generator_random.h"

namespace sightline {
namespace {

uint32_t propSides(uint32_t level, uint32_t most = 128) {
  return std::min(most, 4 + 2 * level);
}

/// Levels from which small things turn up: the smaller, the later.
uint32_t after(uint32_t first, uint32_t level) {
  return level < first ? 0 : level - first + 1;
}

/// A quarter round edge of a lathe: from (r0, y0) to (r1, y1), bulging to the outside.
void addRound(std::vector<LathePoint>& profile, float r0, float y0, float r1, float y1, uint32_t steps) {
  for (uint32_t i = 0; i <= steps; ++i) {
    const Turn t = turn(0.25f * float(i) / float(steps));
    profile.push_back({r0 + (r1 - r0) * t.sin, y0 + (y1 - y0) * (1 - t.cos)});
  }
}

}  // namespace

void makeTable(MeshBuilder& mesh, uint32_t level) {
  const uint32_t own = after(1, level);
  if (own == 0) return;
  const float top = kTableHeight;
  std::vector<LathePoint> plate{{0, top - 0.03f}};
  addRound(plate, 0.345f, top - 0.03f, 0.36f, top - 0.015f, 1 + own / 3);
  plate.push_back({0.36f, top - 0.005f});
  plate.push_back({0.355f, top});
  plate.push_back({0, top});
  mesh.lathe(plate, propSides(own));
  std::vector<LathePoint> stem{{0.22f, 0}, {0.22f, 0.015f}};
  addRound(stem, 0.2f, 0.02f, 0.03f, 0.06f, 1 + own / 3);
  stem.push_back({0.025f, 0.3f});
  stem.push_back({0.03f, top - 0.03f});
  mesh.lathe(stem, propSides(own, 64));
}

void makeChair(MeshBuilder& mesh, uint32_t level) {
  const uint32_t own = after(2, level);
  if (own == 0) return;
  const uint32_t sides = std::min(24u, 3 + own / 2), bends = std::min(24u, 1 + own / 2);
  for (const float x : {-0.19f, 0.19f}) {
    const glm::vec3 front[] = {{x * 1.1f, 0, 0.21f}, {x, 0.45f, 0.18f}};
    mesh.tube(front, 0.014f, sides, true);
  }
  // Back legs and back are one bent pipe.
  std::vector<glm::vec3> pipe{{-0.2f, 0, -0.24f}, {-0.19f, 0.45f, -0.19f}};
  for (uint32_t i = 0; i <= 2 * bends; ++i) {
    const Turn t = turn(0.5f - 0.5f * float(i) / float(2 * bends));
    pipe.push_back({0.19f * t.cos, 0.72f + 0.16f * t.sin, -0.22f - 0.03f * t.sin});
  }
  pipe.push_back({0.19f, 0.45f, -0.19f});
  pipe.push_back({0.2f, 0, -0.24f});
  mesh.tube(pipe, 0.013f, sides, true);
  const Frame base = mesh.frame;
  mesh.frame = base.at({0, 0.45f, 0});
  std::vector<LathePoint> seat{{0, -0.01f}};
  addRound(seat, 0.2f, -0.01f, 0.215f, 0.01f, 1 + own / 4);
  seat.push_back({0.2f, 0.02f});
  seat.push_back({0, 0.028f});
  mesh.lathe(seat, propSides(own, 64));
  mesh.frame = base;
  // Woven back: thin strips.
  const uint32_t strips = std::min(24u, 2 + own / 2);
  for (uint32_t i = 0; i < strips; ++i) {
    const float x = -0.15f + 0.3f * (float(i) + 0.5f) / float(strips), w = 0.06f / float(strips);
    mesh.box({x - w, 0.47f, -0.222f}, {x + w, 0.78f, -0.216f});
  }
}

void makeCup(MeshBuilder& mesh, uint32_t level) {
  const uint32_t own = after(4, level);
  if (own == 0) return;
  const uint32_t sides = propSides(own), steps = 1 + own / 2;
  std::vector<LathePoint> saucer{{0, 0.002f}, {0.035f, 0.002f}};
  addRound(saucer, 0.04f, 0.003f, 0.075f, 0.012f, steps);
  saucer.push_back({0.073f, 0.014f});
  saucer.push_back({0.035f, 0.006f});
  saucer.push_back({0, 0.006f});
  mesh.lathe(saucer, sides);
  std::vector<LathePoint> cup{{0, 0.008f}, {0.02f, 0.008f}};
  addRound(cup, 0.022f, 0.012f, 0.038f, 0.065f, steps);
  cup.push_back({0.035f, 0.065f});
  addRound(cup, 0.034f, 0.06f, 0.02f, 0.014f, steps);
  cup.push_back({0, 0.012f});
  mesh.lathe(cup, sides);
  if (own < 2) return;
  std::vector<glm::vec3> handle;
  for (uint32_t i = 0; i <= 2 + steps; ++i) {
    const Turn t = turn(0.3f - 0.6f * float(i) / float(2 + steps));
    handle.push_back({0.038f + 0.017f * t.cos, 0.038f + 0.017f * t.sin, 0});
  }
  mesh.tube(handle, 0.003f, std::min(16u, 3 + own / 2), false);
  const glm::vec3 spoon[] = {{-0.06f, 0.016f, 0.03f}, {0.02f, 0.014f, 0.05f}, {0.035f, 0.013f, 0.053f}};
  const float radii[] = {0.002f, 0.0015f, 0.006f};
  mesh.tube(spoon, radii, std::min(16u, 3 + own / 2), true);
}

void makeBottle(MeshBuilder& mesh, uint32_t level) {
  const uint32_t own = after(3, level);
  if (own == 0) return;
  mesh.use(Matter::kPane);
  const uint32_t sides = propSides(own), steps = 1 + own / 2;
  std::vector<LathePoint> bottle{{0, 0.004f}, {0.034f, 0.002f}, {0.037f, 0.01f}, {0.037f, 0.18f}};
  addRound(bottle, 0.037f, 0.19f, 0.014f, 0.24f, steps);
  for (const LathePoint p : {LathePoint{0.013f, 0.29f}, {0.016f, 0.292f}, {0.016f, 0.305f}, {0, 0.306f}}) {
    bottle.push_back(p);
  }
  mesh.lathe(bottle, sides);
  if (own < 3) return;
  const Frame base = mesh.frame;
  mesh.frame = base.at({0.1f, 0, 0.03f});
  std::vector<LathePoint> glass{
      {0, 0.001f}, {0.03f, 0.001f}, {0.03f, 0.003f}, {0.004f, 0.008f}, {0.003f, 0.07f}};
  addRound(glass, 0.004f, 0.075f, 0.034f, 0.14f, steps);
  glass.push_back({0.0325f, 0.14f});
  glass.push_back({0.02f, 0.09f});
  glass.push_back({0, 0.08f});
  mesh.lathe(glass, sides);
  mesh.frame = base;
}

void makeTableLamp(MeshBuilder& mesh, uint32_t level) {
  const uint32_t own = after(3, level);
  if (own == 0) return;
  std::vector<LathePoint> foot{{0.05f, 0.001f}, {0.05f, 0.012f}};
  addRound(foot, 0.045f, 0.016f, 0.008f, 0.04f, 1 + own / 3);
  foot.push_back({0.008f, 0.18f});
  mesh.lathe(foot, propSides(own));
  const LathePoint shade[] = {{0.085f, 0.14f}, {0.045f, 0.24f}, {0.042f, 0.24f}, {0.082f, 0.14f}};
  mesh.lathe(shade, propSides(own));
}

void makeParasol(MeshBuilder& mesh, uint32_t level) {
  const uint32_t own = after(2, level);
  if (own == 0) return;
  const uint32_t ribs = 8, across = std::min(16u, 1 + own / 3);
  const glm::vec3 pole[] = {{0, 0, 0}, {0, 2.55f, 0}};
  mesh.tube(pole, 0.025f, std::min(32u, 4 + own), true);
  // Cloth hangs through between the ribs: above and below, so that it has two sides.
  const uint32_t columns = ribs * across, rows = 1 + own / 3;
  for (const float lift : {0.0f, -0.01f}) {
    mesh.sheet(columns, rows, true, [&](uint32_t i, uint32_t j) {
      const Turn t = turn((lift == 0 ? -1.0f : 1.0f) * float(i) / float(columns));
      const float s = float(i % across) / float(across), hang = 4 * s * (1 - s);
      const float r = 1.35f - 1.3f * float(j) / float(rows), share = r / 1.35f;
      const float inward = 1 - 0.05f * hang;
      return glm::vec3(r * inward * t.cos, 2.5f - 0.55f * share * share - 0.06f * hang * share + lift,
                       r * inward * t.sin);
    });
  }
  if (own < 3) return;
  for (uint32_t i = 0; i < ribs; ++i) {
    const Turn t = turn(float(i) / float(ribs));
    const glm::vec3 rib[] = {{0.03f * t.cos, 2.0f, 0.03f * t.sin}, {0.7f * t.cos, 2.3f, 0.7f * t.sin}};
    mesh.tube(rib, 0.007f, std::min(12u, 3 + own / 4), false);
  }
}

void makePottedPlant(MeshBuilder& mesh, uint64_t seed, uint32_t level) {
  const uint32_t own = after(2, level);
  if (own == 0) return;
  GeneratorRandom random(seed, 0x91a27);
  const float size = random.uniform(0.7f, 1);
  std::vector<LathePoint> pot{{0, 0.01f},
                              {0.18f * size, 0.01f},
                              {0.25f * size, 0.4f},
                              {0.27f * size, 0.4f},
                              {0.27f * size, 0.45f},
                              {0.24f * size, 0.45f},
                              {0.23f * size, 0.4f},
                              {0, 0.4f}};
  mesh.lathe(pot, propSides(own, 64));
  const uint32_t leaves = 6 + own * (own + 5), pieces = std::min(12u, 1 + own / 2);
  // With holes, a leaf becomes a frond: wide, and mostly air.
  const float widen = mesh.alpha() ? 5.0f : 1.0f;
  mesh.use(Matter::kLeaf);
  for (uint32_t k = 0; k < leaves; ++k) {
    // A leaf goes up and out, bends down, and narrows to its tip.
    const Turn t = turn(random.unit());
    const float out = size * random.uniform(0.15f, 0.65f), high = size * random.uniform(0.4f, 1.2f);
    const float droop = random.uniform(0.2f, 0.9f), width = size * random.uniform(0.015f, 0.035f) * widen;
    const float root_z = 0.15f * size * random.uniform(-1, 1), root_x = 0.15f * size * random.uniform(-1, 1);
    const glm::vec3 root(root_x, 0.4f, root_z);
    const glm::vec3 away(t.cos, 0, t.sin), side(-t.sin, 0, t.cos);
    const float fold = random.uniform(-0.4f, 0.4f);
    mesh.sheet(1, pieces, false, [&](uint32_t i, uint32_t j) {
      const float s = float(j) / float(pieces);
      const glm::vec3 spine = root + away * (out * s) + glm::vec3(0, high * (s - 0.5f * droop * s * s), 0);
      const float half =
          mesh.alpha() ? width * (1 - 0.4f * s) : width * (0.35f + 1.3f * s * (1 - s)) * (1 - 0.9f * s * s);
      return spine + side * (i == 0 ? -half : half) + glm::vec3(0, i == 0 ? -half * fold : half * fold, 0);
    });
  }
}

void makeHairballStrand(MeshBuilder& mesh, float radius, uint64_t seed, uint32_t level) {
  const uint32_t own = after(2, level);
  if (own == 0) return;
  const uint32_t fibres = 2 + own, pieces = std::min(64u, 6 + 2 * own);
  for (uint32_t k = 0; k < fibres; ++k) {
    GeneratorRandom random(seed, 0x4a12ba11, k);
    // Turning about an axis that itself turns, on a radius that swings: a tangle through the whole ball.
    const float a0 = random.unit(), b0 = random.unit(), r0 = random.unit();
    const float da = random.uniform(1.5f, 3.5f), db = random.uniform(0.4f, 1.6f),
                dr = random.uniform(0.5f, 1.5f);
    std::vector<glm::vec3> path;
    for (uint32_t i = 0; i <= pieces; ++i) {
      const float s = float(i) / float(pieces);
      const Turn a = turn(a0 + da * s), b = turn(b0 + db * s);
      const float r = radius * (0.74f + 0.24f * turn(r0 + dr * s).sin);
      const glm::vec3 d(a.cos, a.sin * b.cos, a.sin * b.sin);
      // The poles of three thirds of the fibres lie on different axes.
      const glm::vec3 turned = k % 3 == 0   ? d
                               : k % 3 == 1 ? glm::vec3(d.y, d.z, d.x)
                                            : glm::vec3(d.z, d.x, d.y);
      path.push_back(turned * r + glm::vec3(0, radius, 0));
    }
    mesh.tube(path, 0.0012f * radius, 3, false);
  }
}

void makeStringLights(MeshBuilder& mesh, glm::vec3 a, glm::vec3 b, uint32_t level) {
  const uint32_t own = after(2, level);
  if (own == 0) return;
  const uint32_t steps = std::min(64u, 2 + 2 * own), bulbs = std::min(40u, 3 + own);
  const auto at = [&](float s) { return a + (b - a) * s - glm::vec3(0, 1.6f * s * (1 - s), 0); };
  std::vector<glm::vec3> path;
  for (uint32_t i = 0; i <= steps; ++i) path.push_back(at(float(i) / float(steps)));
  mesh.tube(path, 0.006f, 3, false);
  const Frame base = mesh.frame;
  for (uint32_t i = 0; i < bulbs; ++i) {
    mesh.frame = base.at(at((float(i) + 0.5f) / float(bulbs)));
    std::vector<LathePoint> bulb{{0, -0.11f}};
    addRound(bulb, 0.012f, -0.108f, 0.028f, -0.08f, 1 + own / 4);
    bulb.push_back({0.012f, -0.04f});
    bulb.push_back({0.012f, -0.01f});
    bulb.push_back({0, -0.008f});
    mesh.lathe(bulb, propSides(own, 48));
  }
  mesh.frame = base;
}

}  // namespace sightline
