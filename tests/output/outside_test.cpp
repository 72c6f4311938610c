// What is seen from outside: six cells see what any viewer outside of the bounds does, and no more.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include "core/api/bake.h"
#include "core/device/registry/make_device.h"
#include "core/place/outside_cells.h"
#include "core/strip/lost_rays.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using testing_support::idRange;
using testing_support::quickParams;
using testing_support::Random;
using testing_support::SceneOfBoxes;

/// What the outside cells see.
std::vector<uint32_t> seenFromOutside(const Scene& scene) {
  Session session(scene, {.device = "cpu"});
  std::set<uint32_t> seen;
  for (const CellPvs& cell : bake(session, outsideCells(sceneBounds(scene)), quickParams()).cells) {
    seen.insert(cell.triangles.begin(), cell.triangles.end());
  }
  return {seen.begin(), seen.end()};
}

/// The triangle that the ray meets first, by brute force in double; nothing where two are almost as near, or
/// the ray passes close to an edge.
std::optional<uint32_t> firstByForce(const Scene& scene, const glm::dvec3& from, const glm::dvec3& along) {
  constexpr double kClose = 1e-9;
  std::optional<uint32_t> first;
  double nearest = std::numeric_limits<double>::infinity();
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    const auto c = scene.corners(id);
    const glm::dvec3 a(c[0]), u = glm::dvec3(c[1]) - a, v = glm::dvec3(c[2]) - a;
    const glm::dvec3 p = glm::cross(along, v);
    const double det = glm::dot(u, p);
    if (det == 0) continue;
    const glm::dvec3 to = (from - a) / det, q = glm::cross(to, u);
    const double s = glm::dot(to, p), t = glm::dot(along, q), distance = glm::dot(v, q);
    const double inside = std::min({s, t, 1 - s - t});
    if (inside < -kClose || distance <= 0) continue;
    if (inside < kClose || std::abs(distance - nearest) < kClose * distance) return std::nullopt;
    if (distance > nearest) continue;
    nearest = distance;
    first = id;
  }
  return first;
}

TEST(OutsideCells, AreTheSidesOfABoxAroundTheBoundsThatLookIn) {
  const Bounds boxes[] = {
      {{-1, 2, 3}, {4, 4, 9}}, {{0, 0, 0}, {5, 0, 5}}, {{1e6f, -1e6f, 7}, {1e6f, -1e6f, 8}}};
  for (const Bounds& bounds : boxes) {
    const std::vector<ViewCell> cells = outsideCells(bounds);
    ASSERT_EQ(cells.size(), 6u);
    glm::vec3 low(1e30f), high(-1e30f);
    for (size_t i = 0; i < 6; ++i) {
      SCOPED_TRACE(cells[i].name);
      const int axis = int(i / 2);
      const bool above = i % 2 == 1;
      ASSERT_TRUE(cells[i].flat());
      const std::vector<Face> faces = cellFaces(cells[i]);
      ASSERT_EQ(faces.size(), 1u);
      const glm::vec3 normal(faces[0].normal);
      for (int k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(normal[k], k == axis ? (above ? -1 : 1) : 0) << k;
      for (const glm::vec3& corner : cellCorners(cells[i])) {
        low = glm::min(low, corner);
        high = glm::max(high, corner);
        // Strictly outside, so that it touches no triangle, and around the side of the bounds.
        EXPECT_TRUE(above ? corner[axis] > bounds.high[axis] : corner[axis] < bounds.low[axis]);
        for (int k = 0; k < 3; ++k) {
          EXPECT_TRUE(k == axis || corner[k] < bounds.low[k] || corner[k] > bounds.high[k]);
        }
      }
    }
    for (size_t i = 0; i < 6; ++i) {  // they meet at the box's edges
      for (const glm::vec3& corner : cellCorners(cells[i])) {
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(corner[k] == low[k] || corner[k] == high[k]);
      }
    }
  }
}

TEST(OutsideCells, SeeTheShellAndNothingInIt) {
  SceneOfBoxes boxes;
  boxes.addBox({0, 0, 0}, {10, 10, 10});
  boxes.addBox({1, 1, 1}, {9, 9, 9});
  boxes.addBox({4, 4, 4}, {5, 5, 5});
  EXPECT_EQ(seenFromOutside(boxes.finish()), idRange(0, 12));
}

TEST(OutsideCells, SeeThroughAnOpeningWhatCanBeSeenThroughIt) {
  SceneOfBoxes boxes;
  for (const float y : {0.0f, 10.0f}) boxes.addRectangle({0, y, 0}, {10, 0, 0}, {0, 0, 10});
  for (const float x : {0.0f, 10.0f}) boxes.addRectangle({x, 0, 0}, {0, 10, 0}, {0, 0, 10});
  boxes.addRectangle({0, 0, 0}, {10, 0, 0}, {0, 10, 0});  // z = 10 is open
  const uint32_t screen = boxes.addRectangle({1, 0, 9}, {8, 0, 0}, {0, 10, 0});
  const uint32_t behind = boxes.addBox({4, 4, 2}, {6, 6, 8.875f});
  const std::vector<uint32_t> seen = seenFromOutside(boxes.finish());
  EXPECT_TRUE(std::includes(seen.begin(), seen.end(), &screen, &screen + 1));
  // Past the screen's sides, one unit wide, the box's outer sides show, but not the one that the screen
  // faces.
  const auto has = [&](uint32_t id) { return std::binary_search(seen.begin(), seen.end(), id); };
  EXPECT_TRUE(has(behind) && has(behind + 2));
  EXPECT_FALSE(has(behind + 10) || has(behind + 11));
}

TEST(OutsideCells, HoldWhatViewersOutsideSee) {
  Random random(7);
  for (int round = 0; round < 4; ++round) {
    Scene scene = testing_support::soup(random, 150, round % 2 == 0 ? 0.8f : 0.3f, 1.0f);
    const std::vector<uint32_t> seen = seenFromOutside(scene);
    const Bounds bounds = sceneBounds(scene);
    const glm::dvec3 center = glm::dvec3(bounds.low + bounds.high) / 2.0,
                     half = glm::dvec3(bounds.high) - center;
    int tried = 0;
    while (tried < 3000) {
      // From close by to far away.
      const glm::dvec3 from = center + half * glm::dvec3(random.point(random.pick(2) == 0 ? 1.2f : 30.0f));
      if (glm::all(glm::lessThanEqual(glm::abs(from - center), half))) continue;
      const auto c = scene.corners(random.pick(scene.triangleCount()));
      const float u = random.unit(), v = random.unit() * (1 - u);
      const glm::dvec3 to =
          glm::dvec3(c[0]) + glm::dvec3(c[1] - c[0]) * double(u) + glm::dvec3(c[2] - c[0]) * double(v);
      const auto first = firstByForce(scene, from, to - from);
      if (!first) continue;
      ++tried;
      ASSERT_TRUE(std::binary_search(seen.begin(), seen.end(), *first))
          << "round " << round << ", triangle " << *first;
    }
  }
}

/// A scene on the cpu device, with the tree that it needs.
struct OnCpu {
  explicit OnCpu(const Scene& scene)
      : bvh(buildBvh(scene.positions, scene.triangles)), device(makeDevice("cpu", scene, bvh)) {}
  operator Tracer&() { return *device; }
  Bvh bvh;
  std::unique_ptr<Device> device;
};

TEST(LostRays, CountsWhatWentAndIsSeen) {
  SceneOfBoxes whole_boxes, left_boxes, right_boxes, far_boxes;
  whole_boxes.addRectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  whole_boxes.addRectangle({4, 0, 0}, {4, 0, 0}, {0, 4, 0});
  left_boxes.addRectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  right_boxes.addRectangle({4, 0, 0}, {4, 0, 0}, {0, 4, 0});
  far_boxes.addRectangle({0, 0, 9}, {4, 0, 0}, {0, 4, 0});  // behind the cell
  const Scene whole = whole_boxes.finish(), left = left_boxes.finish(), right = right_boxes.finish(),
              far = far_boxes.finish();
  Scene turned = whole;
  for (glm::uvec3& t : turned.triangles) t = {t.y, t.z, t.x};
  const ViewCell cell{"c", {4, 2, 1}, {8, 4, 0}, {0, 180, 0}};
  OnCpu whole_tracer(whole), left_tracer(left), right_tracer(right), far_tracer(far), turned_tracer(turned);
  const auto lost = [&](const Scene& scene, Tracer& tracer) {
    uint32_t rays = 20'000;
    const LostRays found = countLostRays({whole, whole_tracer}, {scene, tracer}, cell, 0, 1, rays);
    EXPECT_EQ(found.ties, 0u);
    return found.lost;
  };
  EXPECT_EQ(lost(whole, whole_tracer), 0u);
  EXPECT_EQ(lost(turned, turned_tracer), 0u);  // the same triangles
  // Rays that meet anything meet one of the halves.
  const uint64_t all = lost(far, far_tracer);
  EXPECT_GT(all, 5'000u);
  EXPECT_EQ(lost(left, left_tracer) + lost(right, right_tracer), all);
  EXPECT_GT(lost(left, left_tracer), all / 3);
  EXPECT_GT(lost(right, right_tracer), all / 3);
  std::vector<bool> seen(4, false);
  EXPECT_EQ(markSeen({left, left_tracer}, cell, 0, 1, 20'000, seen), 2u);
  EXPECT_EQ(seen, (std::vector<bool>{true, true, false, false}));
  EXPECT_EQ(markSeen({whole, whole_tracer}, cell, 0, 1, 20'000, seen), 2u);
  EXPECT_EQ(seen, std::vector<bool>(4, true));
  uint32_t rays = 1u << 30;
  EXPECT_EQ(countLostRays(
                {whole, whole_tracer}, {left, left_tracer}, cell, 0, 1, rays,
                [](uint64_t) {
                  return false;
                }).lost > 0,
            true);
  EXPECT_LT(rays, 1u << 30);  // what was traced when it was ended
}

}  // namespace
}  // namespace sightline
