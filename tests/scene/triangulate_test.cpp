#include "core/formats/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/scene/scene.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using Triangles = std::vector<glm::uvec3>;

/// With all the tests that a file has.
bool triangulate(const std::vector<glm::vec3>& corners, Triangles& triangles) {
  uint64_t tests = kMaxCutTests;
  return sightline::triangulate(corners, triangles, tests);
}

Triangles cut(const std::vector<glm::vec3>& corners) {
  Triangles triangles;
  EXPECT_TRUE(triangulate(corners, triangles));
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  return triangles;
}

glm::dvec3 areaVector(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return 0.5 * glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

/// The triangles have the outline's orientation and together exactly its area: they cover it without overlap.
void expectCovers(const std::vector<glm::vec3>& corners, double tolerance) {
  glm::dvec3 outline(0.0);
  for (size_t i = 1; i + 1 < corners.size(); ++i)
    outline += areaVector(corners[0], corners[i], corners[i + 1]);
  double area = 0.0;
  for (const glm::uvec3& t : cut(corners)) {
    const glm::dvec3 one = areaVector(corners[t.x], corners[t.y], corners[t.z]);
    EXPECT_GE(glm::dot(one, outline), -tolerance * glm::length(outline));
    area += glm::length(one);
  }
  EXPECT_NEAR(area, glm::length(outline), tolerance);
}

TEST(Triangulate, ConvexPolygonsBecomeFans) {
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (Triangles{{0, 1, 2}}));
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(cut({{0, 0, 5}, {0, 1, 5}, {1, 1, 5}, {1, 0, 5}}), (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Triangulate, ConcaveQuadIsCutAtItsInnerCorner) {
  for (size_t shift = 0; shift < 4; ++shift) {
    const std::vector<glm::vec3> dart = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
    std::vector<glm::vec3> corners;
    for (size_t i = 0; i < 4; ++i) corners.push_back(dart[(i + shift) % 4]);
    expectCovers(corners, 1e-12);
    std::reverse(corners.begin(), corners.end());
    expectCovers(corners, 1e-12);
  }
}

TEST(Triangulate, SpiralsAndCombs) {
  std::vector<glm::vec3> comb;
  for (int i = 0; i < 20; ++i) {
    comb.emplace_back(2.0 * i, 0.0, double(i));
    comb.emplace_back(2.0 * i + 1.0, 10.0, i + 0.5);
  }
  comb.emplace_back(39, -1, 19.5f);
  comb.emplace_back(0, -1, 0);
  expectCovers(comb, 1e-9);
  std::vector<glm::vec3> spiral;
  for (int i = 0; i < 60; ++i)
    spiral.emplace_back((i + 5) * std::cos(i * 0.4), 3, (i + 5) * std::sin(i * 0.4));
  for (int i = 59; i >= 0; --i)
    spiral.emplace_back((i + 2) * std::cos(i * 0.4), 3, (i + 2) * std::sin(i * 0.4));
  expectCovers(spiral, 1e-2);
}

TEST(Triangulate, RandomStarShapedPolygonsInAnyPlane) {
  constexpr uint64_t kSeed = 17;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 500; ++round) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " round " + std::to_string(round));
    const glm::dvec3 normal =
        glm::normalize(glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5));
    const glm::dvec3 u = glm::normalize(glm::cross(normal, glm::dvec3(0.3, 0.5, 0.7)));
    const glm::dvec3 v = glm::cross(normal, u);
    const int n = 4 + int(random() % 40);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < n; ++i) {
      const double angle = 6.283185307179586 * (i + 0.9 * unit(random)) / n;
      const double radius = 1.0 + 9.0 * unit(random);
      corners.emplace_back(radius * (std::cos(angle) * u + std::sin(angle) * v) +
                           glm::dvec3(100.0, -50.0, 7.0));
    }
    expectCovers(corners, 1e-3);
  }
}

TEST(Triangulate, OutlineWithAHole) {
  // A frame: the outline goes in along a bridge, around the hole, and back.
  expectCovers({{0, 0, 0},
                {9, 0, 0},
                {9, 9, 0},
                {0, 9, 0},
                {0, 0, 0},
                {3, 3, 0},
                {3, 6, 0},
                {6, 6, 0},
                {6, 3, 0},
                {3, 3, 0}},
               1e-9);
}

TEST(Triangulate, DegenerateOutlinesStillGiveTriangles) {
  cut({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}});                // a bow tie
  cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0.1f, 0, 0}});  // crossing edges
  cut({{3e38f, 3e38f, 0}, {-3e38f, 3e38f, 0}, {-3e38f, -3e38f, 3e38f}, {3e38f, -3e38f, 0}});
  std::mt19937_64 random(1);
  for (int round = 0; round < 300; ++round) {
    std::vector<glm::vec3> corners(3 + random() % 12);
    for (glm::vec3& corner : corners) corner = {random() % 3, random() % 3, random() % 2};
    for (const glm::uvec3& t : cut(corners)) {
      for (int i = 0; i < 3; ++i) EXPECT_LT(t[i], corners.size());
    }
  }
}

TEST(Triangulate, LargePolygons) {
  Triangles triangles;
  std::vector<glm::vec3> star;
  for (size_t i = 0; i <= kMaxConcaveCorners; ++i) {
    const double angle = 6.283185307179586 * double(i) / double(kMaxConcaveCorners + 1);
    const double radius = i % 2 == 0 ? 1.0 : 2.0;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  EXPECT_FALSE(triangulate(star, triangles));
  EXPECT_TRUE(triangles.empty());
  star.pop_back();
  EXPECT_TRUE(triangulate(star, triangles));
  EXPECT_EQ(triangles.size(), star.size() - 2);
}

/// Turns inward and back out, a step apart: it offers an ear at a time only.
std::vector<glm::vec3> spiral(int corners) {
  std::vector<glm::vec3> outline;
  for (int i = 0; i < corners / 2; ++i)
    outline.emplace_back((i + 5) * std::cos(i * 0.4), 3, (i + 5) * std::sin(i * 0.4));
  for (int i = corners / 2 - 1; i >= 0; --i)
    outline.emplace_back((i + 2) * std::cos(i * 0.4), 3, (i + 2) * std::sin(i * 0.4));
  return outline;
}

TEST(Triangulate, EntangledOutlinesTakeQuadraticTime) {
  for (const uint64_t corners : {500, 2000}) {
    Triangles triangles;
    uint64_t tests_left = kMaxCutTests;
    EXPECT_TRUE(sightline::triangulate(spiral(int(corners)), triangles, tests_left));
    EXPECT_LT(kMaxCutTests - tests_left, 2 * corners * corners);  // it was over 60 times that
  }
}

TEST(Triangulate, ThePolygonsOfAFileShareItsTests) {
  Triangles triangles;
  uint64_t tests_left = 250'000;
  EXPECT_TRUE(sightline::triangulate(spiral(400), triangles, tests_left));
  EXPECT_LT(tests_left, 150'000u);
  EXPECT_FALSE(sightline::triangulate(spiral(400), triangles, tests_left));
  EXPECT_EQ(triangles.size(), 398u);
}

TEST(Triangulate, ObjAndPlyCutAlike) {
  const Scene obj = test::loadText("a.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 4 1 2 3\n");
  const Scene ply =
      test::loadText("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0\n4 0 0\n1 1 0\n0 4 0\n4 3 0 1 2\n");
  EXPECT_EQ(obj.triangles, ply.triangles);
  EXPECT_EQ(obj.triangles.size(), 2u);
}

}  // namespace
}  // namespace sightline
