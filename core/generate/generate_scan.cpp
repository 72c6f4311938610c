// A scan: a statue on its plinth, alone, six metres high whatever the count, which goes into detail as a
// scanner's does.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/cell/rotation.h"
#include "core/generate/scan_surface.h"
#include "core/generate/scene_generators.h"
#include "core/generate/walk_plan.h"

namespace sightline {

namespace {

constexpr uint32_t kVerticesATime = 1 << 20;
constexpr size_t kPanelsATime = 16;

/// Calls take with those vertices, in order and in pieces.
void makePositions(const ScanSurface& surface, const std::function<void(std::span<const glm::vec3>)>& take) {
  std::vector<glm::vec3> positions;
  for (uint32_t first = 0; first < surface.vertexCount(); first += kVerticesATime) {
    positions.resize(std::min(kVerticesATime, surface.vertexCount() - first));
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, uint32_t(positions.size()), 4096),
                      [&](const auto& range) {
                        for (uint32_t i = range.begin(); i < range.end(); ++i)
                          positions[i] = surface.position(first + i);
                      });
    take(positions);
  }
}

void makeTriangles(const ScanSurface& surface, const std::function<void(std::span<const glm::uvec3>)>& take) {
  const std::vector<ScanSurface::Panel>& panels = surface.panels();
  std::vector<std::vector<glm::uvec3>> some(kPanelsATime);
  for (size_t first = 0; first < panels.size(); first += kPanelsATime) {
    const size_t count = std::min(kPanelsATime, panels.size() - first);
    tbb::parallel_for(size_t(0), count, [&](size_t i) {
      some[i].clear();
      surface.addTriangles(panels[first + i], some[i]);
    });
    for (size_t i = 0; i < count; ++i) take(some[i]);
  }
}

}  // namespace

SceneStream scanStream(uint64_t triangles, uint64_t seed, bool holes,
                       const std::function<void(uint32_t vertices, uint32_t of)>& measured) {
  const auto surface = std::make_shared<const ScanSurface>(triangles, seed, holes);
  const std::vector<ScanSurface::Panel>& panels = surface->panels();
  std::vector<uint32_t> counts(panels.size());
  tbb::parallel_for(size_t(0), panels.size(),
                    [&](size_t i) { counts[i] = surface->triangleCount(panels[i]); });
  SceneStream stream;
  for (size_t i = 0; i < panels.size(); ++i) {
    if (counts[i] != 0) stream.objects.push_back({panels[i].name, stream.triangleCount(), counts[i]});
  }
  stream.vertices = surface->vertexCount();
  stream.bounds = {surface->position(0), surface->position(0)};
  uint32_t done = 0;
  makePositions(*surface, [&](std::span<const glm::vec3> some) {
    for (const glm::vec3& p : some)
      stream.bounds = {glm::min(stream.bounds.low, p), glm::max(stream.bounds.high, p)};
    done += uint32_t(some.size());
    if (measured) measured(done, stream.vertices);
  });
  stream.positions = [surface](const auto& take) { makePositions(*surface, take); };
  stream.triangles = [surface](const auto& take) { makeTriangles(*surface, take); };
  return stream;
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
