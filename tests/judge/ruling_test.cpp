// What the judge makes of answers that rounding explains, and of those that it does not.
#include "core/judge/ruling.h"

#include <gtest/gtest.h>

#include "tests/judge/judge_cases.h"

namespace sightline {
namespace {

Ray rayTo2(vec3 origin, vec3 target) {
  return {vec4(origin, 0), vec4(target - origin, 0)};
}

struct Court {
  Scene scene;
  Bvh bvh;
  explicit Court(Scene s) : scene(std::move(s)), bvh(buildBvh(scene.positions, scene.triangles)) {}
  Verdict verdict(const Ray& ray, uint32_t triangle, float t, double steps = 16) const {
    const Judge judge(scene, bvh);
    return rule(judge, ray, {t, triangle}, judge.nearest(judgeRay(ray)), {steps}).verdict;
  }
};

/// A fan of four triangles about (0, 0, 5), id 0..3, before a wall at z = 9, id 4.
Scene fan(int triangles = 4) {
  Scene scene;
  const vec3 ring[] = {{1, 0, 5}, {0, 1, 5.25f}, {-1, 0, 5}, {0, -1, 4.75f}};
  for (int i = 0; i < triangles; ++i) {
    judge_test::addTriangle(scene, {0, 0, 5}, ring[i], ring[(i + 1) % 4]);
  }
  judge_test::addTriangle(scene, {-50, -50, 9}, {50, -50, 9}, {0, 90, 9});
  return scene;
}

const Ray kAtCentre = rayTo2({0.5f, -0.25f, 0}, {0, 0, 5});

TEST(Ruling, NoRayPassesACornerInsideASurface) {
  const Court court(fan());
  for (uint32_t id = 0; id < 4; ++id) EXPECT_EQ(court.verdict(kAtCentre, id, 1), Verdict::kRight);
  EXPECT_EQ(court.verdict(kAtCentre, 4, 1.8f), Verdict::kMissed);
  EXPECT_EQ(court.verdict(kAtCentre, kNoTriangle, 0), Verdict::kMissed);
}

TEST(Ruling, ARayAtASilhouetteMayPassByRoundingOnly) {
  const Court court(fan(3));  // a quarter of the fan is open
  EXPECT_EQ(court.verdict(kAtCentre, 0, 1), Verdict::kRight);
  EXPECT_EQ(court.verdict(kAtCentre, 3, 1.8f), Verdict::kRounded);
  EXPECT_EQ(court.verdict(kAtCentre, kNoTriangle, 0), Verdict::kMissed) << "the wall is behind";
  const Ray inside = rayTo2({0.5f, -0.25f, 0}, {0.01f, 0.01f, 5});
  EXPECT_EQ(court.verdict(inside, 3, 1.8f), Verdict::kMissed);
  const Ray beside = rayTo2({0.5f, -0.25f, 0}, {1e-6f, -1e-6f, 5});  // 4 to 5 steps away from the fan
  EXPECT_EQ(court.verdict(beside, 3, 1.8f), Verdict::kRight);
  EXPECT_EQ(court.verdict(beside, 0, 1), Verdict::kRounded);
  EXPECT_EQ(court.verdict(beside, 0, 1, 1), Verdict::kWrong) << "one step does not get there";
}

TEST(Ruling, SurfacesThatTouchWithoutSharingCornersMayPart) {
  Scene scene;
  judge_test::addTriangle(scene, {-1, 0, 5}, {1, 0, 5}, {0, 1, 5});
  judge_test::addTriangle(scene, {-3, 0, 5}, {3, 0, 5}, {0, -1, 5});
  judge_test::addTriangle(scene, {-50, -50, 9}, {50, -50, 9}, {0, 90, 9});
  const Court junction(scene);
  const Ray ray = rayTo2({0, 0, 0}, {0.3f, 0, 5});
  EXPECT_EQ(junction.verdict(ray, 0, 1), Verdict::kRight);
  EXPECT_EQ(junction.verdict(ray, 2, 1.8f), Verdict::kRounded);
  // The same edge for both: nothing may pass.
  scene.positions[3] = scene.positions[0];
  scene.positions[4] = scene.positions[1];
  EXPECT_EQ(Court(scene).verdict(ray, 2, 1.8f), Verdict::kMissed);
}

TEST(Ruling, WhatRoundingMayPutBehindTheOriginIsNotInTheWay) {
  Scene scene;
  judge_test::addTriangle(scene, {-50, -50, 1e-7f}, {50, -50, 1e-7f}, {0, 90, 1e-7f});
  judge_test::addTriangle(scene, {-50, -50, 9}, {50, -50, 9}, {0, 90, 9});
  const Court court(scene);
  const Ray ray{vec4(0), vec4(0.1f, 0.2f, 1, 0)};
  EXPECT_EQ(court.verdict(ray, 0, 1e-7f), Verdict::kRight);
  EXPECT_EQ(court.verdict(ray, 1, 9), Verdict::kRounded);
  EXPECT_EQ(court.verdict(ray, kNoTriangle, 0), Verdict::kMissed);
}

TEST(Ruling, DistancesMustBeThoseOfTheTriangle) {
  const Court court(fan());
  const Ray ray = rayTo2({0.5f, -0.25f, 0}, {0.2f, 0.3f, 5});
  const Judge judge(court.scene, court.bvh);
  const auto exact = judge.nearest(judgeRay(ray));
  ASSERT_EQ(exact.triangles, std::vector<uint32_t>{0});
  const auto t = float(exact.t.low);
  EXPECT_EQ(court.verdict(ray, 0, t), Verdict::kRight);
  EXPECT_EQ(court.verdict(ray, 0, t * (1 + 4e-7f)), Verdict::kRight);
  EXPECT_EQ(court.verdict(ray, 0, t * (1 + 1e-5f)), Verdict::kWrong);
  EXPECT_EQ(court.verdict(ray, 0, t * (1 - 1e-5f)), Verdict::kWrong);
  EXPECT_EQ(court.verdict(ray, 0, -t), Verdict::kWrong);
  EXPECT_EQ(court.verdict(ray, 0, NAN), Verdict::kWrong);
  EXPECT_EQ(court.verdict(ray, 77, t), Verdict::kWrong) << "no such triangle";
  EXPECT_EQ(court.verdict(ray, 1, t), Verdict::kWrong) << "not where the ray passes";
}

TEST(Ruling, AnOverlapOfCoplanarTrianglesLeavesTheChoice) {
  Scene scene;
  judge_test::addTriangle(scene, {-1, -1, 5}, {1, -1, 5}, {0, 1, 5});
  judge_test::addTriangle(scene, {-2, -1, 4.9999995f}, {2, -1, 4.9999995f}, {0, 1, 4.9999995f});
  const Court court(scene);
  const Ray ray = rayTo2({0, 0, 0}, {0.1f, 0.2f, 5});
  EXPECT_EQ(court.verdict(ray, 1, 1), Verdict::kRight);
  EXPECT_EQ(court.verdict(ray, 0, 1), Verdict::kRounded);
  EXPECT_EQ(court.verdict(ray, 0, 1, 0.1), Verdict::kMissed);
}

}  // namespace
}  // namespace sightline
