// Gaps that are too narrow to count: single rays through slits and holes, both ways, and the sets of bakes.
#include "core/trace/narrow_gap.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/api/bake.h"
#include "core/bake/bake.h"
#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/find_leaks.h"
#include "core/scene/find_objects.h"
#include "core/scene/scene_tree.h"
#include "tests/support/bake_scene.h"
#include "tests/support/leaky_room.h"
#include "tests/support/make_cell.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using testing_support::idRange;
using testing_support::LeakyRoom;
using testing_support::makeCell;
using testing_support::quickParams;
using testing_support::Random;
using testing_support::SceneOfBoxes;

/// A wall behind the plane z = 0, of two sheets or so thick, with a slit of this width about x = 0, and far
/// behind it another. The last two triangles are those of that.
Scene slitScene(float gap, float thickness) {
  SceneOfBoxes boxes;
  // The rims are corners of the sheets, so that the gap is as wide as floats near 0 say.
  const uint32_t sides = thickness > 0 ? 3 : 1;
  for (const float side : {-1.0f, 1.0f}) {
    boxes.addRectangle({side * gap / 2, -50, 0}, {side * 50, 0, 0}, {0, 100, 0});
    if (sides == 1) continue;
    boxes.addRectangle({side * gap / 2, -50, thickness}, {side * 50, 0, 0}, {0, 100, 0});
    boxes.addRectangle({side * gap / 2, -50, 0}, {0, 0, thickness}, {0, 100, 0});
  }
  boxes.addRectangle({-500, -500, 30}, {1000, 0, 0}, {0, 1000, 0});
  return boxes.finish();
}

/// Rays that begin so far before the slit, at least, and pass it at a random place, in a random direction up
/// to 70 degrees from the wall's normal.
std::vector<Ray> raysThrough(float gap, float before, size_t count, Random& random) {
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const float through_y = random.unit() * 4 - 2, through_x = (random.unit() - 0.5f) * gap * 0.999f;
    const vec3 through(through_x, through_y, 0);
    const float length = 0.5f + random.unit(), y = random.unit() * 4 - 2, x = random.unit() * 4 - 2;
    const vec3 direction = vec3(x, y, 1) * length;
    rays.push_back(
        {vec4(through - direction * (before / direction.z * (1 + random.unit())), 0), vec4(direction, 0)});
  }
  return rays;
}

struct Counts {
  uint64_t through = 0, pinched = 0;
};

Counts pinchedThrough(float gap, float width, float thickness) {
  const Scene scene = slitScene(gap, thickness);
  const uint32_t behind = scene.triangleCount() - 2;
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice("cpu", scene, bvh);
  Random random(7);
  const std::vector<Ray> rays = raysThrough(gap, 1 + 2 * width, 2000, random);
  std::vector<Hit> hits(rays.size());
  device->traceRays(rays, hits);
  std::vector<Pinch> pinches;
  findPinched(*device, scene, width, rays, hits, pinches);
  Counts counts;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].triangle < behind) continue;
    ++counts.through;
    if (!pinches[i].pinched) continue;
    ++counts.pinched;
    EXPECT_LT(pinches[i].nearer.triangle, behind);
    EXPECT_LT(std::abs(pinches[i].place.z - thickness / 2), thickness / 2 + 1e-4f)
        << "the gap lies in the wall";
    EXPECT_LT(std::abs(pinches[i].place.x), gap + 8 * width);
  }
  return counts;
}

class SlitOf : public testing::TestWithParam<float> {};

TEST_P(SlitOf, NoRayThroughANarrowerOneCounts) {
  for (const float thickness : {0.0f, 0.1f}) {
    for (const float share : {0.02f, 0.3f, 0.7f, 0.99f}) {
      const Counts counts = pinchedThrough(GetParam(), GetParam() / share, thickness);
      if (thickness == 0) {
        EXPECT_GT(counts.through, 1900u);
      }
      EXPECT_EQ(counts.pinched, counts.through) << share << " thickness " << thickness;
    }
  }
}

/// Whatever the slant, of thick walls, too.
TEST_P(SlitOf, EveryRayThroughAWiderOneCounts) {
  for (const float thickness : {0.0f, GetParam(), 20 * GetParam()}) {
    for (const float times : {2.06f, 3.0f, 20.0f}) {
      const Counts counts = pinchedThrough(GetParam(), GetParam() / times, thickness);
      EXPECT_GT(counts.through, thickness > GetParam() ? 10u : 400u);
      // A ray that touches a rim is as good as stopped by it, up to the rounding of where it begins.
      EXPECT_LE(counts.pinched, 1 + counts.through / 1000) << times << " thickness " << thickness;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Millimetres, SlitOf, testing::Values(0.0001f, 0.001f, 0.01f, 0.05f));

/// A round hole is narrow in every direction; and a pole in the open pinches nothing.
TEST(NarrowGap, HolesAndPoles) {
  SceneOfBoxes boxes;
  constexpr int kSides = 24;
  const auto at = [](int i, float radius) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    return vec3(radius * float(std::cos(angle)), radius * float(std::sin(angle)), 0);
  };
  for (int i = 0; i < kSides; ++i) {
    boxes.addTriangle(at(i, 0.005f), at(i, 20), at(i + 1, 20));
    boxes.addTriangle(at(i, 0.005f), at(i + 1, 20), at(i + 1, 0.005f));
  }
  const uint32_t wall = boxes.addRectangle({-50, -50, 9}, {100, 0, 0}, {0, 100, 0});
  boxes.addBox({-1.001f, -5, 4}, {-0.999f, 5, 4.002f});  // a pole of 2 mm behind
  const Scene scene = boxes.finish();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice("cpu", scene, bvh);
  const auto isPinched = [&](const vec3& origin, float width) {
    const Ray ray{vec4(origin, 0), vec4(0, 0, 1, 0)};
    std::vector<Hit> hits(1);
    device->traceRays({&ray, 1}, hits);
    EXPECT_GE(hits[0].triangle, wall);
    std::vector<Pinch> pinches;
    findPinched(*device, scene, width, {&ray, 1}, hits, pinches);
    return pinches[0].pinched;
  };
  for (const float x : {-0.004f, 0.0f, 0.002f}) {
    EXPECT_TRUE(isPinched({x, 0, -1}, 0.0101f)) << x;
    EXPECT_FALSE(isPinched({0, 0, -1}, 0.0048f));
  }
  EXPECT_FALSE(isPinched({-0.99f, 0, 1}, 0.05f)) << "a pole on one side only";
}

/// The corner of a room is no gap, however fine its triangles.
TEST(NarrowGap, CornersAreNoGaps) {
  SceneOfBoxes boxes;
  boxes.addRectangle({-5, 0, -5}, {10, 0, 0}, {0, 0, 10});
  boxes.addRectangle({-5, 0, 5}, {10, 0, 0}, {0, 10, 0});
  boxes.addRectangle({5, 0, -5}, {0, 0, 10}, {0, 10, 0});
  const Scene scene = boxes.finish();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice("cpu", scene, bvh);
  Random random(3);
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) {
    const vec3 from(random.unit() * 8 - 4, 0.5f + random.unit() * 3, random.unit() * 8 - 4);
    const vec3 to(5 - 0.02f * random.unit() * random.unit(), 0.02f * random.unit(),
                  5 - 0.02f * random.unit());
    rays.push_back({vec4(from, 0), vec4(to - from, 0)});
  }
  std::vector<Hit> hits(rays.size());
  device->traceRays(rays, hits);
  std::vector<Pinch> pinches;
  findPinched(*device, scene, 0.01f, rays, hits, pinches);
  for (size_t i = 0; i < rays.size(); ++i) EXPECT_FALSE(pinches[i].pinched) << i;
}

CellPvs bakeHole(const std::string& driver, const Scene& scene, float hole) {
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  BakeParams params = quickParams();
  params.smallest_hole = hole;
  auto device = makeDevice(driver, scene, bvh);
  if (hole > 0) device = makeNaiveDevice(std::move(device), scene, hole);
  return bakeCell(*device, scene, makeCell({0, 1.5, 0}, {0.5, 0.5, 0.5}), 0, params);
}

uint64_t behindWalls(const LeakyRoom& room, const CellPvs& pvs) {
  return uint64_t(std::ranges::count_if(pvs.triangles, [&](uint32_t id) { return id >= room.mosaic; }));
}

TEST(SmallestHole, ClosesNarrowerGapsOfARoomAndNoWiderOnes) {
  const LeakyRoom closed(0, 16), narrow(0.002f, 16), wide(0.05f, 16);
  EXPECT_EQ(behindWalls(closed, bakeHole("cpu", closed.scene, 0)), 0u);
  const uint64_t leaking = behindWalls(narrow, bakeHole("cpu", narrow.scene, 0));
  EXPECT_GT(leaking, 10u);
  const CellPvs without_leaks = bakeHole("cpu", narrow.scene, 0.0021f);
  EXPECT_EQ(behindWalls(narrow, without_leaks), 0u);
  EXPECT_LE(without_leaks.stats.missing_rays, 10u) << "validation looks through gaps";
  // What is in the room stays.
  const CellPvs exact = bakeHole("cpu", narrow.scene, 0);
  EXPECT_GE(without_leaks.triangles.size() + leaking, exact.triangles.size());
  // Gaps of 50 mm are open for holes of half their width.
  const CellPvs open = bakeHole("cpu", wide.scene, 0), same = bakeHole("cpu", wide.scene, 0.0125f);
  EXPECT_GT(behindWalls(wide, open), 20u);
  EXPECT_GE(double(behindWalls(wide, same)), 0.98 * double(behindWalls(wide, open)));
}

TEST(SmallestHole, IsTheSameOnEveryDeviceAndRun) {
  const LeakyRoom room(0.005f, 8);
  const CellPvs cpu = bakeHole("cpu", room.scene, 0.004f), opencl = bakeHole("opencl", room.scene, 0.004f);
  EXPECT_EQ(cpu.triangles, opencl.triangles);
  for (size_t i = 0; i < cpu.witnesses.size(); ++i) {
    EXPECT_EQ(cpu.witnesses[i].origin, opencl.witnesses[i].origin) << i;
  }
}

/// Each witness has room on its way: what is in the set is right.
TEST(SmallestHole, WitnessesHaveRoom) {
  const LeakyRoom room(0.012f, 8);
  constexpr float kHole = 0.008f;
  const CellPvs pvs = bakeHole("cpu", room.scene, kHole);
  const Bvh bvh = buildBvh(room.scene.positions, room.scene.triangles);
  const auto device = makeDevice("cpu", room.scene, bvh);
  std::vector<Ray> rays;
  for (const Witness& w : pvs.witnesses) rays.push_back({vec4(w.origin, 0), vec4(w.direction, 0)});
  std::vector<Hit> hits(rays.size());
  device->traceRays(rays, hits);
  std::vector<Pinch> pinches;
  findPinched(*device, room.scene, kHole, rays, hits, pinches);
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i].triangle, pvs.triangles[i]);
    EXPECT_FALSE(pinches[i].pinched) << pvs.triangles[i];
  }
}

TEST(Leaks, AreTheTrianglesBehindGaps) {
  const LeakyRoom room(0.0002f, 16), closed(0, 16);
  const Bvh bvh = buildBvh(room.scene.positions, room.scene.triangles);
  const auto device = makeDevice("cpu", room.scene, bvh);
  const CellPvs pvs = bakeHole("cpu", room.scene, 0);
  const uint64_t behind = behindWalls(room, pvs);
  ASSERT_GT(behind, 3u);
  const Leaks leaks = findLeaks(*device, room.scene, pvs, leakWidth(pvs.cell));
  EXPECT_FLOAT_EQ(leaks.width, 0.0005f);
  EXPECT_GE(leaks.triangles, behind);
  EXPECT_LE(leaks.triangles, behind + 4) << "floor and ceiling reach past the walls, too";
  const glm::dvec3 at = glm::abs(leaks.place);
  EXPECT_NEAR(std::max(at.x, at.z), 3, 0.001) << "in a wall";
  const Leaks again = findLeaks(*device, room.scene, pvs, leakWidth(pvs.cell));
  EXPECT_EQ(again.triangles, leaks.triangles);
  EXPECT_EQ(again.rays, leaks.rays);
  EXPECT_LE(leaks.rays, 17 * pvs.triangles.size() + 289 * (leaks.triangles + 100));

  const CellPvs tight = bakeHole("cpu", closed.scene, 0);
  const Bvh closed_bvh = buildBvh(closed.scene.positions, closed.scene.triangles);
  const auto closed_device = makeDevice("cpu", closed.scene, closed_bvh);
  EXPECT_EQ(findLeaks(*closed_device, closed.scene, tight, leakWidth(tight.cell)).triangles, 0u);
}

/// Glass behind a gap is a leak as well, also where what ends the ray is; glass in the room, and what is seen
/// past it, is none.
TEST(Leaks, CountGlass) {
  LeakyRoom room(0.0002f, 16);
  const auto isGlass = [](uint32_t id) { return id % 3 == 0; };
  Scene& scene = room.scene;
  scene.surfaces.words.assign(scene.triangleCount(), 0);
  for (uint32_t id = room.mosaic; id < scene.triangleCount(); ++id) {
    scene.surfaces.words[id] = isGlass(id) ? kSurfaceGlass : 0u;
  }
  // A pane before a wall inside.
  SceneOfBoxes panes;
  panes.addRectangle({-2.9f, 0.1f, 2.5f}, {5.8f, 0, 0}, {0, 2.8f, 0});
  const Scene pane = panes.finish();
  const auto first = uint32_t(scene.positions.size());
  const uint32_t pane_id = scene.triangleCount();
  scene.positions.insert(scene.positions.end(), pane.positions.begin(), pane.positions.end());
  for (const glm::uvec3& t : pane.triangles) scene.triangles.push_back(t + first);
  scene.surfaces.words.resize(scene.triangleCount(), kSurfaceGlass);
  scene.objects.back().triangle_count += 2;
  const Bvh bvh = buildSceneTree(scene);
  for (const char* driver : {"cpu", "opencl"}) {
    const auto device = makeDevice(driver, scene, bvh);
    const CellPvs pvs = bakeCell(*device, scene, makeCell({0, 1.5, 0}, {0.5, 0.5, 0.5}), 0, quickParams());
    uint64_t behind = 0, glass = 0;
    for (const uint32_t id : pvs.triangles) {
      behind += id >= room.mosaic && id < pane_id ? 1 : 0;
      glass += id >= room.mosaic && id < pane_id && isGlass(id) ? 1 : 0;
    }
    EXPECT_TRUE(std::ranges::binary_search(pvs.triangles, pane_id));
    ASSERT_GT(glass, 3u) << driver;
    const Leaks leaks = findLeaks(*device, scene, pvs, leakWidth(pvs.cell));
    EXPECT_GE(leaks.triangles, behind) << driver;
    EXPECT_LE(leaks.triangles, behind + 4) << driver << ": floor and ceiling reach past the walls, too";
  }
}

}  // namespace
}  // namespace sightline
