// Rays and triangles of view cells by the cells' definition, and how much rounding is let pass.
#include "core/verify/cell_sight.h"

#include <gtest/gtest.h>

#include "core/sampling/make_stage_params.h"
#include "core/shared/random_ray.h"
#include "core/shared/reverse.h"
#include "tests/judge/judge_cases.h"

namespace sightline {
namespace {

using judge_test::Random;

ViewCell cellAt(const glm::dvec3& center, const glm::dvec3& size,
                const glm::dvec3& rotation = glm::dvec3(0.0)) {
  return {"cell", center, size, rotation};
}

Fault fault(const ViewCell& cell, const glm::vec3& origin, const glm::vec3& direction) {
  const JudgeTriangle anywhere{{0, 0, -1e6}, {1, 0, 1e6}, {0, 1, 1e6}};
  return CellSight(cell).faultOf(anywhere, {origin, direction, kStageRandom});
}

TEST(CellSight, RaysOfABoxBeginOnItOrInIt) {
  const ViewCell box = cellAt({1, 2, 3}, {2, 2, 2});
  for (const glm::vec3 inside : {glm::vec3(0, 2, 3), {1, 2, 3}, {2, 3, 4}, {1.5f, 1, 3}}) {
    for (const glm::vec3 along : {glm::vec3(1, 0, 0), {-1, 0, 0}, {0, 1e-20f, 0}, {-3, 2, 1}}) {
      EXPECT_EQ(fault(box, inside, along), Fault::kNone) << inside.x << " " << along.x;
    }
  }
  EXPECT_EQ(fault(box, {-0.0001f, 2, 3}, {1, 0, 0}), Fault::kOffCell);
  EXPECT_EQ(fault(box, {2, 3, 4.001f}, {1, 0, 0}), Fault::kOffCell);
  EXPECT_EQ(fault(box, {1, 2, 3}, {0, 0, 0}), Fault::kNoRay);
  EXPECT_EQ(fault(box, {1, NAN, 3}, {1, 0, 0}), Fault::kNoRay);
  EXPECT_EQ(fault(box, {1, 2, 3}, {1, HUGE_VALF, 0}), Fault::kNoRay);
}

TEST(CellSight, FlatCellsLookAlongTheirNormalAndSheetsToBothSides) {
  const ViewCell flat = cellAt({0, 0, 5}, {2, 2, 0});
  EXPECT_EQ(fault(flat, {0, 0, 5}, {1, 0, 1e-30f}), Fault::kNone);
  EXPECT_EQ(fault(flat, {0, 0, 5}, {1, 0, 0}), Fault::kBackwards);
  EXPECT_EQ(fault(flat, {0, 0, 5}, {1, 0, -1e-30f}), Fault::kBackwards);
  const ViewCell turned = cellAt({0, 0, 5}, {2, 2, 0}, {0, 180, 0});
  EXPECT_EQ(fault(turned, {0, 0, 5}, {1, 0, 1e-30f}), Fault::kBackwards);
  EXPECT_EQ(fault(turned, {0, 0, 5}, {1, 0, -1e-30f}), Fault::kNone);
  const ViewCell sheet = cellAt({0, 0, 5}, {0, 2, 2});
  EXPECT_EQ(fault(sheet, {0, 0, 5}, {1, 0, 0}), Fault::kNone);
  EXPECT_EQ(fault(sheet, {0, 0, 5}, {-1, 0, 0}), Fault::kNone);
  EXPECT_EQ(fault(sheet, {0.1f, 0, 5}, {1, 0, 0}), Fault::kOffCell);
}

TEST(CellSight, TrianglesBehindAFlatCellsPlane) {
  const CellSight flat(cellAt({0, 0, 5}, {2, 2, 0}));
  const auto behind = [&](double a, double b, double c) {
    return flat.isBehind({{-100, 3, a}, {7, 100, b}, {7, -9, c}});
  };
  EXPECT_TRUE(behind(4, 3, -1e5));
  EXPECT_TRUE(behind(5 - 2e-4, 3, 2));
  EXPECT_FALSE(behind(5 - 5e-5, 3, 2)) << "rounding may explain it: 2^-20 of 100 are 1e-4";
  EXPECT_FALSE(behind(5 + 1e-4, 3, 2)) << "it crosses the plane";
  EXPECT_FALSE(behind(5, 5, 5)) << "in the plane: no ray meets it exactly, some may by rounding";
  EXPECT_FALSE(behind(6, 7, 8));
  EXPECT_FALSE(CellSight(cellAt({0, 0, 5}, {2, 2, 1})).isBehind({{0, 0, -9}, {1, 0, -9}, {0, 1, -9}}));
}

/// What a bake's own float code makes of a cell, near and far, straight and turned: all of it passes, and
/// what lies off by some thousand roundings does not.
TEST(CellSight, LetsRoundingPassAndNothingMore) {
  Random random(3);
  for (int round = 0; round < 400; ++round) {
    const double far = std::exp2(int(random.pick(30)) - 10), size = std::exp2(int(random.pick(12)) - 6);
    const glm::dvec3 center = glm::dvec3(random.point(1)) * far;
    glm::dvec3 rotation(0.0);
    for (int axis = 0; axis < 3 && round % 4 != 0; ++axis) {
      rotation[axis] = random.pick(3) == 0 ? 90.0 * random.pick(4) : double(random.unit()) * 360;
    }
    const ViewCell cell = cellAt(center, {size, size * 0.7, round % 2 == 0 ? 0 : size * 0.3}, rotation);
    const CellSight sight(cell);
    const std::vector<Face> faces = cellFaces(cell);
    const StageParams params = makeStageParams(BakeParams{}, faces, uvec4(1, 2, 3, 4));
    for (uint32_t i = 0; i < 100; ++i) {
      const Face& face = faces[i % faces.size()];
      const Ray ray = randomRay(random.pick(1u << 30), 0, face, params.shifts);
      ASSERT_TRUE(sight.beginsOnCell(glm::dvec3(ray.origin))) << testing_support::describeRay(ray);
      ASSERT_TRUE(sight.looksAlong(glm::dvec3(ray.direction))) << testing_support::describeRay(ray);
      const vec3 corner = reverseOrigin(face, i, i % 16, params);
      ASSERT_TRUE(sight.beginsOnCell(glm::dvec3(corner)));
      // Directions that the float test of a face lets pass, close to its plane.
      const vec3 way = random.point(1), beside = way - xyz3(face.normal) * dot3(way, xyz3(face.normal));
      if (cell.flat() && dot3(beside, xyz3(face.normal)) > 0) {
        ASSERT_TRUE(sight.looksAlong(glm::dvec3(beside)));
      }
    }
    const glm::dvec3 normal = cellFrame(cell).axes[2];
    const double much = 0x1p-18 * (glm::length(center) + size) * 2;
    const glm::dvec3 front = center + normal * cell.size.z * 0.5;
    EXPECT_FALSE(sight.beginsOnCell(front + normal * much));
    if (!cell.flat()) continue;
    EXPECT_FALSE(sight.beginsOnCell(front - normal * much));
    const glm::dvec3 along = cellFrame(cell).axes[0];
    EXPECT_FALSE(sight.looksAlong(along - normal * 0x1p-18));
    EXPECT_TRUE(sight.looksAlong(along + normal * 0x1p-18));
  }
}

}  // namespace
}  // namespace sightline
