#include "core/shared/border.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/shared/gvs_border.h"

namespace sightline {
namespace {

StageParams params(uint32_t n_edge, float relative, float absolute) {
  StageParams p{};
  p.counts = uvec4(n_edge, 20, 20, 1);
  p.distances = vec4(relative, absolute, 0x1p-10f, 0);
  return p;
}

Ray rayOf(vec3 a, vec3 b, vec3 c, uint32_t k, vec3 origin, const StageParams& p) {
  return borderRay(borderEdge(a, b, c, borderSide(k, p.counts.x), origin, p), k, origin, p);
}

/// Orthonormal frame at right angles to the ray through p: what the ray's origin sees.
struct View {
  glm::dvec3 right, up;
  explicit View(glm::dvec3 r) {
    r = glm::normalize(r);
    right = glm::normalize(glm::cross(r, std::abs(r.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    up = glm::cross(r, right);
  }
};

/// Central projection from `origin` onto the plane at right angles to the view through `axis`, scaled so that
/// lengths at the axis point keep.
glm::dvec2 project(const View& view, glm::dvec3 origin, glm::dvec3 axis, glm::dvec3 p) {
  const double depth = glm::dot(p - origin, glm::normalize(axis - origin));
  const double scale = glm::length(axis - origin) / depth;
  return glm::dvec2(glm::dot(p - origin, view.right), glm::dot(p - origin, view.up)) * scale;
}

bool inside(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  const auto side = [](glm::dvec2 s, glm::dvec2 t, glm::dvec2 q) {
    return (t.x - s.x) * (q.y - s.y) - (t.y - s.y) * (q.x - s.x);
  };
  const double u = side(a, b, p), v = side(b, c, p), w = side(c, a, p);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

struct Sight {
  vec3 a, b, c, origin;
};

class BorderPolygon : public testing::TestWithParam<int> {
 protected:
  /// Triangles of every shape: kind 0 ordinary, 1 needles, 2 other winding, 3 far away, 4 grazing.
  Sight make(std::mt19937& random, int kind) {
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
    Sight s{point(), point(), point(), point() * 10.0f + vec3(0, 0, 30)};
    if (kind == 1) s.c = s.a + (s.b - s.a) * 0.5f + point() * 0.01f;
    if (kind == 2) std::swap(s.a, s.b);
    if (kind == 3) s.origin = s.origin * 100.0f;
    if (kind == 4) s.origin = s.a + (s.b - s.a) * 20.0f + point() * 0.5f;
    return s;
  }
};

TEST_P(BorderPolygon, LiesOutsideTheTriangleAtTheAskedDistance) {
  const uint32_t seed = 100 + GetParam();
  std::mt19937 random(seed);
  const StageParams p = params(5, 0x1p-12f, 0);
  for (int round = 0; round < 2000; ++round) {
    const Sight s = make(random, GetParam());
    for (uint32_t k = 0; k < borderRayCount(p.counts.x, p); ++k) {
      const vec3 x = borderPoint(borderEdge(s.a, s.b, s.c, borderSide(k, 5), s.origin, p), k);
      const uint32_t edge = k / 8, place = k % 8;
      const vec3 corners[3] = {s.a, s.b, s.c};
      const vec3 corner = corners[place == 7 ? (edge + 1) % 3 : edge];
      const View view(glm::dvec3(corner) - glm::dvec3(s.origin));
      const glm::dvec3 origin(s.origin), axis(corner);
      const auto at = [&](vec3 q) { return project(view, origin, axis, glm::dvec3(q)); };
      ASSERT_FALSE(inside(at(x), at(s.a), at(s.b), at(s.c)))
          << "seed " << seed << " round " << round << " sample " << k;
      if (place < 2 || place == 7) {
        const double asked = borderDistance(corner, s.origin, p);
        ASSERT_NEAR(glm::length(glm::dvec3(x) - glm::dvec3(corner)), asked, asked * 0.02)
            << "seed " << seed << " round " << round << " sample " << k;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BorderPolygon, testing::Range(0, 5));

/// The reference implementation had the case distinction of equation 5.4 the other way round.
TEST(BorderVertex, BisectorPointsAwayFromBluntAndSharpCorners) {
  const StageParams p = params(0, 0, 0.001f);
  const vec3 origin(0, 0, 10);
  const auto bisector = [&](vec3 a, vec3 b, vec3 c) { return borderVertex(a, b, c, 0, origin, p) - a; };
  const vec3 sharp = bisector(vec3(0, 0, 0), vec3(1, 0.1f, 0), vec3(1, -0.1f, 0));
  EXPECT_NEAR(sharp.x, -0.001f, 1e-6f);
  EXPECT_NEAR(sharp.y, 0.0f, 1e-6f);
  const vec3 blunt = bisector(vec3(0, 0, 0), vec3(0.1f, 1, 0), vec3(0.1f, -1, 0));
  EXPECT_NEAR(blunt.x, -0.001f, 1e-6f);
  EXPECT_NEAR(blunt.y, 0.0f, 1e-6f);
}

TEST(BorderRay, EdgeAlongTheRayGivesFiniteRays) {
  const StageParams p = params(3, 0x1p-17f, 0);
  for (uint32_t k = 0; k < borderRayCount(p.counts.x, p); ++k) {
    const Ray ray = rayOf(vec3(0, 0, 1), vec3(0, 0, 2), vec3(1, 0, 3), k, vec3(0, 0, 0), p);
    ASSERT_TRUE(std::isfinite(ray.direction.x + ray.direction.y + ray.direction.z)) << k;
    ASSERT_GT(maxAbs3(xyz3(ray.direction)), 0.0f);
  }
}

TEST(BorderRay, ScalesByPowersOfTwoBitForBit) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-5, 5);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  const StageParams p = params(4, 0x1p-17f, 0);
  for (int round = 0; round < 1000; ++round) {
    const vec3 a = point(), b = point(), c = point(), o = point();
    for (uint32_t k = 0; k < borderRayCount(p.counts.x, p); ++k) {
      const Ray once = rayOf(a, b, c, k, o, p);
      const Ray scaled = rayOf(a * 1024.0f, b * 1024.0f, c * 1024.0f, k, o * 1024.0f, p);
      ASSERT_EQ(once.direction * 1024.0f, scaled.direction) << "round " << round << " sample " << k;
    }
  }
}

TEST(BorderSamples, FollowTheLongestEdgesApparentSize) {
  StageParams p = params(30, 0x1p-17f, 0);
  const auto samples = [&](float size, float distance) {
    return borderSamples(vec3(0, 0, distance), vec3(size, 0, distance), vec3(0, size / 4, distance), vec3(0),
                         p);
  };
  EXPECT_EQ(samples(1e-6f, 100), 30u);  // without a spacing always all
  p.spacing.x = 0.001f;
  // The hypotenuse is the longest: sqrt(17) / 4 of size.
  EXPECT_EQ(samples(1, 100), 10u);
  EXPECT_EQ(samples(2, 100), 20u);
  EXPECT_EQ(samples(2, 200), 10u);
  EXPECT_EQ(samples(1e-3f, 100), kFewestBorderSamples);
  EXPECT_EQ(samples(50, 100), 30u);
  p.counts.x = 1;
  EXPECT_EQ(samples(50, 100), 1u);
  p.counts.x = 0;
  EXPECT_EQ(samples(50, 100), 0u);
}

/// All samples lie on the sides of the polygon, from end to end, however many there are.
TEST(BorderSamples, LieEvenlyBetweenTheEnds) {
  std::mt19937 random(10);
  std::uniform_real_distribution<float> unit(-5, 5);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  StageParams p = params(12, 0x1p-12f, 0);
  p.spacing.x = 0.02f;
  uint32_t thinned = 0;
  for (int round = 0; round < 1000; ++round) {
    const vec3 a = point() * 0.2f, b = point() * 0.2f, c = point() * 0.2f, o = point() * 3.0f;
    const uint32_t samples = borderSamples(a, b, c, o, p);
    thinned += samples < 12 ? 1 : 0;
    for (uint32_t side = 0; side < 3; ++side) {
      const BorderEdge edge = borderEdge(a, b, c, side, o, p);
      const vec3 start(edge.start), end(edge.end);
      for (uint32_t i = 0; i <= samples + 1; ++i) {
        const uint32_t k = side * (samples + 3) + 1 + i;
        ASSERT_EQ(borderSide(k, samples), side);
        const vec3 wanted = start + (end - start) * (float(i) / float(samples + 1));
        ASSERT_LT(glm::length(borderPoint(edge, k) - wanted), 1e-5f) << "round " << round << " sample " << k;
      }
    }
  }
  EXPECT_GT(thinned, 100u);
  EXPECT_LT(thinned, 1000u);
}

TEST(KeepsDiscontinuity, TheFirstOfARunAndEveryStride) {
  StageParams p = params(30, 0x1p-17f, 0);
  p.method.y = 8;
  EXPECT_TRUE(keepsDiscontinuity(5, false, p));
  EXPECT_FALSE(keepsDiscontinuity(5, true, p));
  EXPECT_TRUE(keepsDiscontinuity(16, true, p));
  p.method.y = 1;
  EXPECT_TRUE(keepsDiscontinuity(5, true, p));
}

TEST(Discontinuity, IsAMissOrAHitClearlyInFront) {
  const StageParams p = params(5, 0x1p-17f, 0);
  Ray ray{vec4(0), vec4(0, 0, 100, 0)};
  EXPECT_TRUE(isDiscontinuity(ray, {0.0f, kNoTriangle}, p));
  EXPECT_TRUE(isDiscontinuity(ray, {0.5f, 3}, p));
  EXPECT_FALSE(isDiscontinuity(ray, {1.5f, 3}, p));
  EXPECT_FALSE(isDiscontinuity(ray, {1.0f, 3}, p));
  EXPECT_FALSE(isDiscontinuity(ray, {1.0f - 0x1p-11f, 3}, p));
  EXPECT_TRUE(isDiscontinuity(ray, {1.0f - 0x1p-9f, 3}, p));
}

/// A flat cell's border rays: none runs behind, by exact arithmetic, and those of triangles that lie in front
/// are what they are without a direction to look in.
TEST(BorderOfFlatCell, LooksOneWay) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  uint32_t kept = 0, dropped = 0;
  for (int round = 0; round < 4000; ++round) {
    StageParams p = params(5, 0x1p-17f, 0), all_around = p;
    if (round % 2 == 1) p.method.x = all_around.method.x = kSampleGvs;
    const vec3 look = normalize3(point()), origin = point() * (round % 3 == 0 ? 1000.0f : 1.0f);
    p.look = vec4(look, 0);
    const vec3 a = origin + point(), b = origin + point(), c = origin + point();
    const auto height = [&](vec3 v) { return glm::dot(glm::dvec3(look), glm::dvec3(v)); };
    const double lowest = std::min({height(a - origin), height(b - origin), height(c - origin)});
    for (uint32_t k = 0; k < borderRayCount(5, p); ++k) {
      const Ray ray = polygonRay(a, b, c, k, 5, origin, p);
      if (hasDirection(ray)) {
        ++kept;
        ASSERT_GT(height(vec3(ray.direction)), 0) << round << ", " << k;
      } else {
        ++dropped;
      }
      if (lowest < 0.01) continue;
      ASSERT_EQ(ray.direction, polygonRay(a, b, c, k, 5, origin, all_around).direction) << round << ", " << k;
    }
  }
  EXPECT_GT(kept, 10'000u);
  EXPECT_GT(dropped, 10'000u);
}

/// Of an edge through the cell's plane the part in front keeps all samples.
TEST(BorderOfFlatCell, CutsEdgesAtItsPlane) {
  StageParams p = params(8, 0x1p-17f, 0);
  p.look = vec4(0, 0, 1, 0);
  const vec3 a(1, -1, -7), b(1, -1, 1), c(3, -1, -7);
  for (uint32_t place = 1; place <= 10; ++place) {  // both ends and the samples between them
    const Ray ray = rayOf(a, b, c, place, vec3(0), p);
    ASSERT_TRUE(hasDirection(ray)) << place;
    EXPECT_NEAR(ray.direction.z, double(place - 1) / 9, 1e-3) << place;
  }
  p.look = vec4(0, 0, -1, 0);
  EXPECT_NEAR(rayOf(a, b, c, 10, vec3(0), p).direction.z, 0, 1e-3);
  EXPECT_FALSE(hasDirection(rayOf(vec3(1, 0, 1), vec3(2, 0, 1), vec3(1, 1, 1), 4, vec3(0), p)));
}

}  // namespace
}  // namespace sightline
