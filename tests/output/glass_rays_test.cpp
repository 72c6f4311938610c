// What strip marks and counts, and what objects take of the view, in scenes with glass: against brute force
// in double, both ways.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/device/registry/make_device.h"
#include "core/export/objects_json.h"
#include "core/sampling/numbered_rays.h"
#include "core/strip/lost_rays.h"
#include "tests/support/brute_sight.h"
#include "tests/support/make_cell.h"
#include "tests/support/random_triangles.h"
#include "tests/support/without_triangles.h"

namespace sightline {
namespace {

using testing_support::bruteSight;
using testing_support::BruteSight;

/// Triangles around a cell, two of three of them panes; four objects.
Scene panesAround(uint32_t seed) {
  testing_support::Random random(seed);
  Scene scene;
  constexpr uint32_t kCount = 48;
  for (uint32_t i = 0; i < kCount; ++i) {
    vec3 center = random.point(3);
    center += glm::normalize(center) * 2.0f;
    testing_support::addTriangle(scene, center + random.point(4.0f), center + random.point(4.0f),
                                 center + random.point(4.0f));
    scene.surfaces.words.push_back(random.pick(3) != 0 ? kSurfaceGlass : 0u);
  }
  for (uint32_t o = 0; o < 4; ++o)
    scene.objects.push_back({"o" + std::to_string(o), o * kCount / 4, kCount / 4});
  return scene;
}

const ViewCell kPaneCell = testing_support::makeCell({0, 0, 0}, {0.5, 0.4, 0.3});
constexpr uint32_t kPaneRays = 6000;

std::vector<BruteSight> bruteSights(const Scene& scene, RandomUse use) {
  const NumberedRays rays(cellFaces(kPaneCell), haltonShifts(1, 0, use), kPaneRays);
  std::vector<BruteSight> sights;
  for (uint32_t i = 0; i < kPaneRays; ++i) sights.push_back(bruteSight(scene, rays.at(i)));
  return sights;
}

class GlassRaysOn : public testing::TestWithParam<const char*> {};

TEST_P(GlassRaysOn, MarkWhatIsSeenThroughGlassAndNothingElse) {
  size_t hidden = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = panesAround(seed);
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    const auto device = makeDevice(GetParam(), scene, bvh);
    std::set<uint32_t> surely, perhaps;
    for (const BruteSight& sight : bruteSights(scene, RandomUse::kCounting)) {
      const auto all = sight.all();
      perhaps.insert(all.begin(), all.end());
      if (sight.sure) surely.insert(all.begin(), all.end());
    }
    std::vector<bool> seen(scene.triangleCount(), false);
    const uint64_t marked = markSeen({scene, *device}, kPaneCell, 0, 1, kPaneRays, seen);
    EXPECT_EQ(marked, uint64_t(std::ranges::count(seen, true)));
    for (uint32_t id = 0; id < seen.size(); ++id) {
      EXPECT_TRUE(seen[id] || !surely.contains(id)) << "seed " << seed << ": " << id << " is not marked";
      EXPECT_TRUE(!seen[id] || perhaps.contains(id)) << "seed " << seed << ": " << id << " is not seen";
      hidden += seen[id] ? 0 : 1;
    }
  }
  EXPECT_GT(hidden, 0u);
}

TEST_P(GlassRaysOn, CountEachRayThatLosesAPane) {
  const Scene scene = panesAround(5);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  const std::vector<BruteSight> sights = bruteSights(scene, RandomUse::kChecking);
  size_t behind = 0;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    if (scene.surfaces.words[id] == 0) continue;
    const NamedTriangles pane[] = {{"", id, 1}};
    const Scene without = testing_support::withoutTriangles(scene, pane);
    const Bvh tree = buildBvh(without.positions, without.triangles);
    const auto other = makeDevice(GetParam(), without, tree);
    uint32_t rays = kPaneRays;
    const LostRays lost = countLostRays({scene, *device}, {without, *other}, kPaneCell, 0, 1, rays);
    uint64_t least = 0, most = 0;
    for (const BruteSight& sight : sights) {
      const auto first = std::ranges::find(sight.glass, id);
      most += first != sight.glass.end() || !sight.sure ? 1 : 0;
      least += first != sight.glass.end() && sight.sure ? 1 : 0;
      behind += first != sight.glass.end() && sight.glass.size() > 1 ? 1 : 0;
    }
    EXPECT_GE(lost.lost, least) << id;
    EXPECT_LE(lost.lost, most) << id;
    EXPECT_EQ(lost.ties, 0u) << id;
  }
  EXPECT_GT(behind, 1000u);  // panes before panes
}

TEST_P(GlassRaysOn, CountForEachObjectThatTheySee) {
  const Scene scene = panesAround(6);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(GetParam(), scene, bvh);
  const ObjectHits hits = countObjectHits(*device, scene, kPaneCell, 0, 1, kPaneRays);
  uint64_t any = 0, unsure = 0, sum = 0;
  std::vector<uint64_t> of_object(4, 0);
  for (const BruteSight& sight : bruteSights(scene, RandomUse::kCounting)) {
    if (!sight.sure) {
      ++unsure;
      continue;
    }
    std::set<uint32_t> objects;
    for (const uint32_t id : sight.all()) objects.insert(id / 12);
    for (const uint32_t object : objects) ++of_object[object];
    any += objects.empty() ? 0 : 1;
  }
  EXPECT_LT(unsure, 20u);
  EXPECT_GE(hits.hits, any);
  EXPECT_LE(hits.hits, any + unsure);
  for (size_t o = 0; o < 4; ++o) {
    EXPECT_GE(hits.of_object[o], of_object[o]) << o;
    EXPECT_LE(hits.of_object[o], of_object[o] + unsure) << o;
    sum += of_object[o];
  }
  EXPECT_GT(sum, any);  // a ray sees several
}

INSTANTIATE_TEST_SUITE_P(On, GlassRaysOn, testing::Values("cpu", "opencl"));

}  // namespace
}  // namespace sightline
