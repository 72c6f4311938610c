// Sets of two devices that differ for a known reason.
#include "core/crosscheck/pvs_difference.h"

#include <gtest/gtest.h>

#include "core/base/interrupted.h"
#include "core/crosscheck/crosscheck_report.h"
#include "tests/judge/wrong_device.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

using judge_test::WrongDevice;

TEST(PvsDifference, TellsOtherRaysFromRealDisagreement) {
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-4, -3, -5}, {4, 3, 5});
  const uint32_t box = boxes.addBox({0, -1, -1}, {1, 1, 1});
  const Scene scene = boxes.finish();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  const ViewCell cell{"cell", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {0, 0, 0}};
  const auto cpu = makeCpuDevice(scene, bvh, {});
  const BakeParams params = testing_support::quickParams();

  // The box's triangles are missing; rays pass those with an even id. Two of its faces can be seen.
  WrongDevice wrong(scene, bvh, [&](const Ray&, Hit& hit) {
    if (hit.triangle < box || hit.triangle % 2 != 0 || hit.triangle == kNoTriangle) return false;
    hit = {0, kNoTriangle};
    return true;
  });
  PvsDifference difference = comparePvs(judge, scene, cell, 0, *cpu, wrong, params);
  EXPECT_EQ(difference.only[0] + difference.only[1], 0u);

  wrong.loseFromSet([&](uint32_t triangle) { return triangle >= box; });
  difference = comparePvs(judge, scene, cell, 0, *cpu, wrong, params);
  EXPECT_EQ(difference.cell, "cell");
  EXPECT_EQ(difference.sizes[0] - difference.sizes[1], difference.only[0]);
  EXPECT_EQ(difference.only[1], 0u);
  EXPECT_GE(difference.only[0], 2u);
  EXPECT_EQ(difference.other_rays[0] * 2, difference.only[0]);
  ASSERT_EQ(difference.disputed.size() * 2, difference.only[0]);
  EXPECT_EQ(difference.count(0, Verdict::kRight), difference.disputed.size());
  EXPECT_EQ(difference.count(1, Verdict::kMissed), difference.disputed.size());
  for (const DisputedTriangle& its : difference.disputed) {
    EXPECT_EQ(its.triangle % 2, 0u);
    EXPECT_EQ(its.found_by, 0u);
    EXPECT_EQ(its.hits[0].triangle, its.triangle);
  }
  // The other way round.
  difference = comparePvs(judge, scene, cell, 0, wrong, *cpu, params);
  EXPECT_EQ(difference.only[0], 0u);
  EXPECT_EQ(difference.count(0, Verdict::kMissed), difference.disputed.size());
  EXPECT_EQ(pvsDifferenceJson("a", "b", {difference})["cells"][0]["disputed"][0]["found_by"], "b");

  const std::atomic<bool> stop = true;
  EXPECT_THROW(comparePvs(judge, scene, cell, 0, *cpu, wrong, params, {}, {.stop = &stop}), Interrupted);
}

TEST(PvsDifference, FindsTrianglesThatAreNotOfTheCell) {
  testing_support::SceneOfBoxes boxes;
  boxes.addRectangle({-9, -9, 9}, {20, 0, 0}, {0, 20, 0});
  const uint32_t behind = boxes.addRectangle({-9, -9, -9}, {20, 0, 0}, {0, 20, 0});
  const uint32_t floor = boxes.addRectangle({-9, -2, -9}, {0, 0, 18}, {20, 0, 0});
  const Scene scene = boxes.finish();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const ViewCell cell{"flat", {0, 0, 0}, {2, 1, 0}, {0, 0, 0}};
  const auto cpu = makeCpuDevice(scene, bvh, {});
  WrongDevice wrong(scene, bvh, [](const Ray&, Hit&) { return false; });
  const auto entryTo = [](uint32_t triangle, vec3 origin, vec3 direction) {
    return PvsEntry{
        uvec4(floatBitsToUint(origin.x), floatBitsToUint(origin.y), floatBitsToUint(origin.z), triangle),
        uvec4(floatBitsToUint(direction.x), floatBitsToUint(direction.y), floatBitsToUint(direction.z),
              kStageBorder)};
  };
  wrong.spoilSet([&](std::vector<PvsEntry>& entries) {
    std::erase_if(entries, [&](const PvsEntry& entry) { return entry.origin_triangle.w >= behind; });
    entries.push_back(entryTo(behind, {0.5f, 0.25f, 0}, {0, 0, -9}));
    entries.push_back(entryTo(floor, {0.5f, 0.25f, 0}, {0, -2, -1}));
    entries.push_back(entryTo(floor + 1, {0.5f, 0.25f, 1}, {0, -2.25f, 1}));
  });
  BakeParams params = testing_support::quickParams();
  params.method = Method::kRandom;  // rays before the plane alone
  const PvsDifference difference = comparePvs(Judge(scene, bvh), scene, cell, 0, *cpu, wrong, params);
  EXPECT_EQ(difference.faults(0), 0u);
  ASSERT_EQ(difference.faults(1), 3u);
  EXPECT_EQ(difference.faulty[0].triangle, behind);
  EXPECT_EQ(difference.faulty[0].fault, Fault::kBehind);
  EXPECT_EQ(difference.faulty[1].fault, Fault::kBackwards);
  EXPECT_EQ(difference.faulty[2].fault, Fault::kOffCell);
  const Json json = pvsDifferenceJson("a", "b", {difference});
  EXPECT_EQ(json["cells"][0]["faulty"][2]["fault"], "off_cell");
  EXPECT_EQ(json["cells"][0]["faulty"][2]["found_by"], "b");

  CrosscheckReport report;
  report.devices.resize(2);
  report.devices[1].id = "b";
  report.wrong_in_sets = {difference.faults(0), difference.faults(1)};
  CrosscheckLimits limits;
  limits.wrong = 3;
  EXPECT_TRUE(pastLimits(report, limits).empty());
  limits.wrong = 2;
  EXPECT_EQ(pastLimits(report, limits), std::vector<std::string>{"b: 3 wrong, at most 2 allowed"});
}

}  // namespace
}  // namespace sightline
