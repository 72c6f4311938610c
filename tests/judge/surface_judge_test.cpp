// The judge on holes, sides and glass: against what is known of constructed rays, and against the cpu's
// answers.
#include <gtest/gtest.h>

#include <random>

#include "core/device/cpu/cpu_device.h"
#include "core/judge/ruling.h"
#include "core/scene/masked_triangle.h"
#include "core/scene/scene_tree.h"
#include "tests/support/instanced_scene.h"

namespace sightline {
namespace {

/// A square of 8 by 8 texels in the plane z = 1, of which every other one holds, before a wall at z = 0.
Scene leafBeforeWall(uint32_t flags = 0) {
  Scene scene;
  Surfaces& surfaces = scene.surfaces;
  const uint32_t mask =
      addMask(surfaces, 8, 8, {kWrapClamp, kWrapClamp}, [](uint64_t i) { return (i % 8 + i / 8) % 2 == 0; });
  const auto add = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, uint32_t word) {
    const auto first = uint32_t(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {a, b, c});
    scene.triangles.emplace_back(first, first + 1, first + 2);
    surfaces.words.push_back(word);
  };
  const glm::dvec2 lower[] = {{0, 0}, {0, 8}, {8, 8}}, upper[] = {{0, 0}, {8, 8}, {8, 0}};
  surfaces.masked = {*maskedTriangle(surfaces, mask, {lower[0], lower[1], lower[2]}),
                     *maskedTriangle(surfaces, mask, {upper[0], upper[1], upper[2]})};
  add({0, 8, 1}, {0, 0, 1}, {8, 0, 1}, kSurfaceMasked | flags);
  add({0, 8, 1}, {8, 0, 1}, {8, 8, 1}, kSurfaceMasked | 1u | flags);
  add({-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}, 0);
  scene.objects = {{"all", 0, 3}};
  return scene;
}

JudgeRay straight(double x, double y) {
  return {{x, y, 4}, {0, 0, -1}};
}

TEST(SurfaceJudge, MeetsTexelsExactly) {
  const Scene scene = leafBeforeWall();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  // Texel (x, y from the top) holds where x + y is even; the border belongs to the texel to the right, or
  // below.
  for (const double e : {0x1p-50, 0x1p-30, 0.25}) {
    EXPECT_EQ(judge.nearest(straight(3 + e, 0.5)).contains(2), false) << e;  // texel (3, 7)
    EXPECT_TRUE(judge.nearest(straight(3 - e, 0.5)).contains(2)) << e;       // texel (2, 7)
  }
  EXPECT_FALSE(judge.nearest(straight(3, 0.5)).contains(2));
  EXPECT_TRUE(judge.nearest(straight(2, 0.5)).contains(2));
}

TEST(SurfaceJudge, SeesGlassBeforeWhatEndsARay) {
  const Scene scene = leafBeforeWall(kSurfaceGlass);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  EXPECT_TRUE(judge.nearest(straight(3.5, 0.5)).contains(2));
  EXPECT_TRUE(judge.sees(straight(3.5, 0.5), 0));
  EXPECT_TRUE(judge.sees(straight(3.5, 0.5), 2));
  EXPECT_FALSE(judge.sees(straight(2.5, 0.5), 0));           // a hole
  EXPECT_FALSE(judge.sees({{3.5, 0.5, -4}, {0, 0, 1}}, 0));  // behind the wall
}

TEST(SurfaceJudge, PassesBacks) {
  Scene scene = leafBeforeWall();
  for (uint32_t& word : scene.surfaces.words) word = kSurfaceFrontOnly;
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  EXPECT_TRUE(judge.nearest(straight(2.5, 0.5)).contains(0));
  EXPECT_TRUE(judge.nearest({{2.5, 0.5, -4}, {0, 0, 1}}).missed());
}

TEST(SurfaceJudge, FindsTheCpuRightOrRoundedAndFaultsWrong) {
  const Scene scene = leafBeforeWall();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  const auto device = makeCpuDevice(scene, bvh, {});
  std::mt19937 random(5);
  const auto unit = [&] { return float(random() >> 8) * 0x1p-24f; };
  size_t right = 0, leaf = 0;
  for (int i = 0; i < 4'000; ++i) {
    const float x = 8 * unit(), y = 8 * unit(), u = unit() - 0.5f, v = unit() - 0.5f;
    const Ray ray{vec4(x, y, 3, 0), vec4(u, v, -1, 0)};
    Hit hit;
    device->traceRays({&ray, 1}, {&hit, 1});
    const ExactHit exact = judge.nearest(judgeRay(ray));
    const Verdict verdict = rule(judge, ray, hit, exact).verdict;
    EXPECT_TRUE(verdict == Verdict::kRight || verdict == Verdict::kRounded) << i;
    right += verdict == Verdict::kRight ? 1 : 0;
    leaf += hit.triangle < 2 ? 1 : 0;
  }
  EXPECT_GT(right, 3'900u);
  EXPECT_GT(leaf, 500u);
  // Taken as opaque, a hole is a wrong answer; a leaf that was passed, a missed one.
  const Ray hole{vec4(2.5f, 0.5f, 4, 0), vec4(0, 0, -1, 0)}, texel{vec4(3.5f, 0.5f, 4, 0), vec4(0, 0, -1, 0)};
  EXPECT_EQ(rule(judge, hole, {3, 0}, judge.nearest(judgeRay(hole))).verdict, Verdict::kWrong);
  EXPECT_EQ(rule(judge, texel, {4, 2}, judge.nearest(judgeRay(texel))).verdict, Verdict::kMissed);
}

TEST(SurfaceJudge, RulesInstancesLikeThePlainScene) {
  const Scene scene = testing_support::withSurfaces(testing_support::randomInstances(4, 40, 60, 8), 4),
              flat = flatten(scene);
  const Bvh tree = buildSceneTree(scene), flat_tree = buildBvh(flat.positions, flat.triangles);
  const Judge judge(scene, tree), plain(flat, flat_tree);
  testing_support::TestRandom random(6);
  size_t hits = 0, glass = 0;
  for (int i = 0; i < 1'500; ++i) {
    const glm::vec3 from = random.inCube(12);
    const auto t = flat.corners(random.below(flat.triangleCount()));
    const glm::vec3 target = t[0] * 0.3f + t[1] * 0.3f + t[2] * 0.4f;
    const JudgeRay ray = judgeRay({vec4(from, 0), vec4(target - from, 0)});
    const ExactHit got = judge.nearest(ray), wanted = plain.nearest(ray);
    ASSERT_EQ(got.triangles, wanted.triangles) << i;
    ASSERT_EQ(judge.glassBefore(ray, got), plain.glassBefore(ray, wanted)) << i;
    hits += wanted.missed() ? 0 : 1;
    glass += plain.glassBefore(ray, wanted).size();
  }
  EXPECT_GT(hits, 200u);
  EXPECT_GT(glass, 200u);
}

}  // namespace
}  // namespace sightline
