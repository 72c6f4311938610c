// A scan: a statue on its plinth, alone, six metres high whatever the count, which goes into detail as a
// scanner's does.
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/cell/rotation.h"
#include "core/generate/scan_surface.h"
#include "core/generate/scene_generators.h"
#include "core/generate/walk_plan.h"

namespace sightline {

Scene scanScene(uint64_t triangles, uint64_t seed, bool holes) {
  const ScanSurface surface(triangles, seed, holes);
  const std::vector<ScanSurface::Panel>& panels = surface.panels();
  std::vector<uint32_t> counts(panels.size());
  tbb::parallel_for(size_t(0), panels.size(),
                    [&](size_t i) { counts[i] = surface.triangleCount(panels[i]); });
  Scene scene;
  uint32_t all = 0;
  std::vector<uint32_t> first;
  for (size_t i = 0; i < panels.size(); ++i) {
    first.push_back(all);
    if (counts[i] != 0) scene.objects.push_back({panels[i].name, all, counts[i]});
    all += counts[i];
  }
  scene.triangles.resize(all);
  tbb::parallel_for(size_t(0), panels.size(), [&](size_t i) {
    std::vector<glm::uvec3> own;
    own.reserve(counts[i]);
    surface.addTriangles(panels[i], own);
    std::ranges::copy(own, scene.triangles.begin() + first[i]);
  });
  scene.positions.resize(surface.vertexCount());
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, surface.vertexCount(), 4096), [&](const auto& range) {
    for (uint32_t v = range.begin(); v < range.end(); ++v) scene.positions[v] = surface.position(v);
  });
  return scene;
}

// Free space: farther than 1.5 m from the axis above the plinth, and above 6 m.
std::vector<ViewCell> scanCells() {
  return {
      {"flat-1", {0, 2.6, 1.75}, {0.8, 0.6, 0}, {0, 180, 0}},
      {"flat-2", {1.75, 3.2, 0}, {0.6, 0.4, 0}, {0, -90, 0}},
      {"flat-3", {-1.75, 1.6, 0}, {0.6, 0.6, 0}, {0, 98, 0}},
      {"flat-4", {0, 7, 0}, {1, 1, 0}, {90, 0, 0}},
      {"box-1", {0, 2.2, -1.75}, {0.4, 0.4, 0.3}, {0, 0, 0}},
      {"box-2", {0, 6.8, 0}, {1.5, 0.6, 1.5}, {0, 10, 0}},
      {"box-3", {1.2, 1.2, 1.2}, {0.3, 0.3, 0.3}, {0, 45, 0}},
      {"street-1", {1.72, 1.5, 0}, {0.25, 0.4, 2.6}, {0, 0, 0}},
      {"street-2", {0, 2.4, 1.72}, {0.25, 0.4, 2.6}, {0, 90, 0}},
      {"street-3", {-1.72, 3.4, 0}, {0.25, 0.4, 2.2}, {0, 0, 0}},
  };
}

CameraPath scanWalk(uint32_t frames) {
  constexpr double kEye = 1.7, kOut = 3.2, kStep = 15;  // metres, metres from the axis, degrees
  const glm::dvec3 middle(0, 2.5, 0);
  const auto around = [&](double degrees, double out, double height) {
    const CosSin at = cosSinDegrees(degrees);
    return glm::dvec3(out * at.sine, height, out * at.cosine);
  };
  WalkPlan plan(frames);
  const auto follow = [&](double from_share, double to_share, double from, double to) {
    const double steps = std::ceil(std::fabs(to - from) / kStep);
    for (double i = 0; i <= steps; ++i) {
      plan.key(from_share + (to_share - from_share) * (i / steps),
               around(from + (to - from) * (i / steps), kOut, kEye), middle);
    }
  };
  follow(0, kTurnFrom, 0, 150);
  plan.turn(kTurnFrom, kTurnTo, around(150, kOut, kEye), -30, -300);
  follow(kTurnTo, kSecondTo, 150, 270);
  plan.cut(kSideFrom, around(200, kOut, kEye), middle);
  follow(kSideFrom, kSideTo, 200, 90);
  plan.cut(kRiseFrom, around(0, kOut, kEye), middle);
  plan.key(0.78, around(0, kOut, 6), middle);
  plan.seeAll(middle, 6, {0, 0, 1});
  return plan.path();
}

}  // namespace sightline
