// Sets of two devices that differ for a known reason.
#include "core/crosscheck/pvs_difference.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sightline
