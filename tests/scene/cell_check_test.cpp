#include "core/scene/cell_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/generate/generate.h"
#include "core/scene/contained.h"
#include "core/trace/cpu_tracer.h"
#include "tests/support/boxes.h"
#include "tests/support/make_cell.h"

namespace sightline {
namespace {

using testing_support::makeCell;
using testing_support::SceneOfBoxes;

/// A floor of 100 x 100, its front up, with a closed block of 20 x 10 x 20 on its middle.
Scene blockOnAFloor() {
  SceneOfBoxes boxes;
  boxes.addRectangle({-50, 0, -50}, {0, 0, 100}, {100, 0, 0});
  boxes.addBox({-10, 0, -10}, {10, 10, 10});
  return boxes.finish();
}

std::vector<std::vector<CellWarning>> check(const Scene& scene, const std::vector<ViewCell>& cells,
                                            FreeSide free_side = FreeSide::kFront) {
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const CpuTracer tracer(scene, bvh);
  return checkCells(scene, bvh, cells, free_side, [&](std::span<const Ray> rays, std::span<Hit> hits) {
    ASSERT_EQ(rays.size(), hits.size());
    for (size_t i = 0; i < rays.size(); ++i) hits[i] = tracer.trace(rays[i]);
  });
}

using Verdicts = std::vector<CellVerdict>;

Verdicts verdicts(const Scene& scene, const ViewCell& cell, FreeSide free_side = FreeSide::kFront) {
  const auto warnings = check(scene, {cell}, free_side);
  Verdicts result;
  for (const CellWarning& warning : warnings.at(0)) result.push_back(warning.verdict);
  return result;
}

TEST(CellCheck, SaysNothingOfGoodCells) {
  const Scene scene = blockOnAFloor();
  for (const ViewCell& cell :
       {makeCell({30, 1.5, 0}, {2, 2, 2}), makeCell({30, 1.5, 0}, {2, 2, 20}, {0, 30, 0}),
        makeCell({30, 1.5, 0}, {2, 2, 0}), makeCell({30, 1.5, 0}, {0, 2, 2}),
        makeCell({30, 12, 0}, {2, 2, 2}), makeCell({52, 1.5, 0}, {2, 2, 2})}) {
    EXPECT_EQ(verdicts(scene, cell), Verdicts{}) << cell.center.x << " " << cell.center.y;
  }
}

TEST(CellCheck, CountsTheTrianglesThatACellCutsOrTouches) {
  const Scene scene = blockOnAFloor();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto warnings = check(scene, {makeCell({30, 1, -30}, {2, 2, 2}), makeCell({10, 5, 0}, {4, 2, 2})});
  ASSERT_EQ(warnings[0].size(), 1u) << "stands on the floor, near its diagonal";
  EXPECT_EQ(warnings[0][0].verdict, CellVerdict::kMeetsTriangles);
  EXPECT_EQ(warnings[0][0].triangles, containedTriangles(scene, makeCell({30, 1, -30}, {2, 2, 2})).size());
  EXPECT_NE(warnings[0][0].text.find("touches"), std::string::npos);
  ASSERT_GE(warnings[1].size(), 1u);
  EXPECT_EQ(warnings[1][0].triangles, 2u) << "the wall";
  EXPECT_NE(warnings[1][0].text.find("2 triangles"), std::string::npos) << warnings[1][0].text;
}

TEST(CellCheck, OfFlatCellsOnlyWhatIsInFrontCounts) {
  const Scene scene = blockOnAFloor();
  // On the block's wall at x = 10: looking away from it, and along it with the wall through the cell.
  EXPECT_EQ(verdicts(scene, makeCell({10, 5, 0}, {2, 2, 0}, {0, 90, 0})), Verdicts{});
  EXPECT_EQ(verdicts(scene, makeCell({10, 5, 0}, {2, 2, 0})).at(0), CellVerdict::kMeetsTriangles);
  EXPECT_EQ(verdicts(scene, makeCell({10, 5, 0}, {2, 2, 0}, {0, -90, 0})), Verdicts{CellVerdict::kInSolid})
      << "looks into the block";
}

TEST(CellCheck, FindsCellsInsideOfSolids) {
  const Scene scene = blockOnAFloor();
  const ViewCell inside = makeCell({0, 5, 0}, {2, 2, 2}), outside = makeCell({30, 1.5, 0}, {2, 2, 2});
  EXPECT_EQ(verdicts(scene, inside), Verdicts{CellVerdict::kInSolid});
  EXPECT_EQ(verdicts(scene, inside, FreeSide::kBack), Verdicts{});
  EXPECT_EQ(verdicts(scene, outside, FreeSide::kBack), Verdicts{CellVerdict::kInSolid});
  EXPECT_EQ(verdicts(scene, inside, FreeSide::kAny), Verdicts{});
}

TEST(CellCheck, FindsCellsOutsideOfTheScene) {
  const Scene scene = blockOnAFloor();
  for (const glm::dvec3 center : {glm::dvec3(90, 1.5, 0), glm::dvec3(0, -40, 0), glm::dvec3(0, 50, 0)}) {
    EXPECT_EQ(verdicts(scene, makeCell(center, {2, 2, 2}), FreeSide::kAny), Verdicts{CellVerdict::kOutside});
  }
  EXPECT_EQ(verdicts(scene, makeCell({90, 1.5, 0}, {90, 2, 2}), FreeSide::kAny), Verdicts{})
      << "reaches into it";
}

TEST(CellCheck, FindsSizesOfAnotherUnit) {
  Scene scene = blockOnAFloor();  // its diagonal: 142
  EXPECT_EQ(verdicts(scene, makeCell({0, 110, 0}, {200, 2, 2}), FreeSide::kAny),
            Verdicts{CellVerdict::kTooLarge});
  EXPECT_EQ(verdicts(scene, makeCell({30, 1.5, 0}, {1e-4, 1e-4, 1e-4})), Verdicts{CellVerdict::kTooSmall});
  EXPECT_EQ(verdicts(scene, makeCell({30, 1.5, 0}, {2e-4, 2e-4, 2e-4})), Verdicts{});
  EXPECT_EQ(verdicts(scene, makeCell({30, 1.5, 0}, {2, 2, 1e-5})), Verdicts{CellVerdict::kTooSmall})
      << "below the spacing of floats at 30";
  for (glm::vec3& p : scene.positions) p += glm::vec3(5e6f, 0, 0);
  EXPECT_EQ(verdicts(scene, makeCell({5e6 + 30, 1.5, 0}, {2, 2, 2}), FreeSide::kAny),
            Verdicts{CellVerdict::kTooSmall});
  EXPECT_EQ(verdicts(scene, makeCell({5e6 + 30, 3.5, 0}, {4, 4, 4}), FreeSide::kAny), Verdicts{});
}

TEST(CellCheck, JudgesTheSizeOfTheSet) {
  EXPECT_FALSE(checkSetSize(1, 12));
  EXPECT_FALSE(checkSetSize(11, 12));
  EXPECT_EQ(checkSetSize(0, 12)->verdict, CellVerdict::kSeesNothing);
  EXPECT_EQ(checkSetSize(12, 12)->verdict, CellVerdict::kSeesEverything);
}

TEST(CellCheck, TheTreeFindsTheContainedTrianglesThatAFullSearchFinds) {
  const Scene scene = generateScene("bistro", 3'000, 2);
  BvhConfig splits;
  splits.spatial_splits = true;
  const Bvh bvhs[] = {buildBvh(scene.positions, scene.triangles),
                      buildBvh(scene.positions, scene.triangles, splits)};
  const Bounds bounds = sceneBounds(scene);
  const glm::dvec3 extent(bounds.high - bounds.low);
  srand(3);
  const auto random = [] { return rand() / double(RAND_MAX); };
  size_t found = 0;
  for (int round = 0; round < 300; ++round) {
    ViewCell cell = makeCell(glm::dvec3(bounds.low) + extent * glm::dvec3(random(), random(), random()),
                             glm::dvec3(8 * random(), 4 * random(), round % 3 == 0 ? 0 : 8 * random()),
                             glm::dvec3(360 * random(), 360 * random(), 0));
    if (round % 4 == 0) cell.rotation = glm::dvec3(0);
    const std::vector<uint32_t> expected = containedTriangles(scene, cell);
    found += expected.size();
    for (const Bvh& bvh : bvhs)
      ASSERT_EQ(containedTriangles(scene, bvh, cell), expected) << "seed 3 " << round;
  }
  EXPECT_GT(found, 1000u);
}

TEST(CellCheck, GeneratedScenesHaveGoodCells) {
  for (const GeneratedSceneInfo& info : generatedScenes()) {
    const Scene scene = generateScene(info.name, 20'000, 1);
    const std::vector<ViewCell> cells = generateCells(info.name, 20'000, 1);
    const auto warnings = check(scene, cells);
    for (size_t i = 0; i < cells.size(); ++i) {
      for (const CellWarning& warning : warnings[i]) {
        ADD_FAILURE() << info.name << ": " << cells[i].name << " " << warning.text;
      }
    }
  }
}

TEST(SolidProbes, AreSpreadEvenly) {
  const auto probes = solidProbes();
  glm::dvec3 sum(0.0), squares(0.0);
  for (const glm::vec3& d : probes) {
    EXPECT_NEAR(glm::length(d), 1, 1e-6);
    EXPECT_GT(std::min({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}), 1e-6) << "along no axis' plane";
    sum += glm::dvec3(d);
    squares += glm::dvec3(d * d);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis] / kSolidProbes, 0, 0.03);
    EXPECT_NEAR(squares[axis] / kSolidProbes, 1.0 / 3, 0.03);
  }
}

}  // namespace
}  // namespace sightline
