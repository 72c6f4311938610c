// The judge against brute force in exact rationals, written another way: the point where the ray meets the
// plane, then the side of each edge that it lies on, in the plane.
#include "core/judge/judge.h"

#include <CGAL/Gmpq.h>
#include <gtest/gtest.h>

#include "tests/judge/judge_cases.h"

namespace sightline {
namespace {

using judge_test::JudgeCase;
using Rational = CGAL::Gmpq;

struct RationalPoint {
  Rational at[3];
  explicit RationalPoint(vec3 p) : at{Rational(p.x), Rational(p.y), Rational(p.z)} {}
};

/// t of the hit; 0: none.
Rational bruteContact(const Ray& ray, vec3 corner_a, vec3 corner_b, vec3 corner_c) {
  const RationalPoint o{vec3(ray.origin)}, d{vec3(ray.direction)}, a(corner_a), b(corner_b), c(corner_c);
  Rational normal[3], along = 0, height = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = (b.at[j] - a.at[j]) * (c.at[k] - a.at[k]) - (b.at[k] - a.at[k]) * (c.at[j] - a.at[j]);
    along += normal[i] * d.at[i];
    height += normal[i] * (a.at[i] - o.at[i]);
  }
  if (along == 0) return 0;
  const Rational t = height / along;
  if (t <= 0) return 0;
  int drop = 0;
  while (normal[drop] == 0) ++drop;
  const int j = (drop + 1) % 3, k = (drop + 2) % 3;
  const Rational x = o.at[j] + t * d.at[j], y = o.at[k] + t * d.at[k];
  int left = 0, right = 0;
  const RationalPoint* const corners[] = {&a, &b, &c, &a};
  for (int i = 0; i < 3; ++i) {
    const RationalPoint &p = *corners[i], &q = *corners[i + 1];
    const Rational side = (q.at[j] - p.at[j]) * (y - p.at[k]) - (q.at[k] - p.at[k]) * (x - p.at[j]);
    left += side > 0;
    right += side < 0;
  }
  return left > 0 && right > 0 ? Rational(0) : t;
}

struct BruteHit {
  std::vector<uint32_t> triangles;
  Rational t = 0;
};

BruteHit bruteNearest(const Scene& scene, const Ray& ray) {
  BruteHit hit;
  for (uint32_t id = 0; id < scene.triangles.size(); ++id) {
    const glm::uvec3 v = scene.triangles[id];
    const Rational t = bruteContact(ray, scene.positions[v.x], scene.positions[v.y], scene.positions[v.z]);
    if (t == 0 || (!hit.triangles.empty() && t > hit.t)) continue;
    if (hit.triangles.empty() || t < hit.t) hit = {{}, t};
    hit.triangles.push_back(id);
  }
  return hit;
}

TEST(Judge, FindsWhatBruteForceInRationalsFinds) {
  size_t hits = 0, ties = 0, misses = 0;
  for (const JudgeCase& c : judge_test::judgeCases(80, 60)) {
    for (const bool spatial_splits : {false, true}) {
      const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles, {.spatial_splits = spatial_splits});
      const Judge judge(c.scene, bvh);
      for (const Ray& ray : c.rays) {
        const ExactHit hit = judge.nearest(judgeRay(ray));
        const BruteHit expected = bruteNearest(c.scene, ray);
        ASSERT_EQ(hit.triangles, expected.triangles) << c.name << ", ray " << judge_test::describeRay(ray);
        hits += !hit.missed();
        ties += hit.triangles.size() > 1;
        misses += hit.missed();
        if (hit.missed()) continue;
        ASSERT_LE(Rational(hit.t.low), expected.t) << c.name << ", ray " << judge_test::describeRay(ray);
        ASSERT_GE(Rational(hit.t.high), expected.t) << c.name << ", ray " << judge_test::describeRay(ray);
      }
    }
  }
  EXPECT_GT(hits, 700u);
  EXPECT_GT(ties, 100u);
  EXPECT_GT(misses, 20u);
}

TEST(Judge, KnowsWhichTrianglesARayMeetsAndWhere) {
  for (const JudgeCase& c : judge_test::judgeCases(20, 40)) {
    const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
    const Judge judge(c.scene, bvh);
    for (const Ray& ray : c.rays) {
      for (uint32_t id = 0; id < c.scene.triangles.size(); ++id) {
        const glm::uvec3 v = c.scene.triangles[id];
        const Rational expected =
            bruteContact(ray, c.scene.positions[v.x], c.scene.positions[v.y], c.scene.positions[v.z]);
        ASSERT_EQ(judge.meets(judgeRay(ray), id), expected != 0)
            << c.name << ", triangle " << id << ", ray " << judge_test::describeRay(ray);
        if (expected == 0) continue;
        const auto t = judge.planeDistance(judgeRay(ray), id);
        ASSERT_TRUE(t.has_value());
        ASSERT_LE(Rational(t->low), expected);
        ASSERT_GE(Rational(t->high), expected);
        ASSERT_LE(t->high - t->low, t->high * 0x1p-40) << c.name << ", ray " << judge_test::describeRay(ray);
      }
    }
  }
}

TEST(Judge, CountsEdgesAndCornersButNotTrianglesSeenEdgeOnOrStartedFrom) {
  Scene scene;
  judge_test::addTriangle(scene, {0, 0, 5}, {4, 0, 5}, {0, 4, 5});
  judge_test::addTriangle(scene, {0, 0, 5}, {0, 4, 5}, {-4, 0, 5});
  judge_test::addTriangle(scene, {0, 0, 0}, {0, 0, 9}, {0, 9, 0});  // in the plane x = 0, met edge on
  judge_test::addTriangle(scene, {0, 1, 7}, {0, 1, 7}, {3, 1, 7});  // no area
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  using Ids = std::vector<uint32_t>;
  EXPECT_EQ(judge.nearest({{0, 1, 0}, {0, 0, 1}}).triangles, (Ids{0, 1}));     // on their edge
  EXPECT_EQ(judge.nearest({{4, 0, 0}, {0, 0, 2}}).triangles, (Ids{0}));        // its corner
  EXPECT_EQ(judge.nearest({{-1, -1e-300, 0}, {0, 0, 2}}).triangles, (Ids{}));  // just beside
  EXPECT_EQ(judge.nearest({{1, 1, 5}, {0, 0, 1}}).triangles, (Ids{}));         // starts on it
  EXPECT_EQ(judge.nearest({{1, 1, 5}, {1, 0, 0}}).triangles, (Ids{}));         // in its plane
  EXPECT_EQ(judge.nearest({{-1, 1, 1}, {1, 0, 0}}).triangles, (Ids{2}));
}

}  // namespace
}  // namespace sightline
