#include "core/voxel/triangle_rows.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Iso_cuboid_3.h>
#include <CGAL/Segment_3.h>
#include <CGAL/Triangle_3.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <set>

#include "tests/voxel/random_numbers.h"

namespace sightline {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using TestTriangle = std::array<glm::dvec3, 3>;

bool meetsExactly(const TestTriangle& t, const glm::ivec3& voxel) {
  const auto point = [](const glm::dvec3& p) { return Kernel::Point_3(p.x, p.y, p.z); };
  const Kernel::Iso_cuboid_3 cube(Kernel::Point_3(voxel.x, voxel.y, voxel.z),
                                  Kernel::Point_3(voxel.x + 1, voxel.y + 1, voxel.z + 1));
  const Kernel::Triangle_3 triangle(point(t[0]), point(t[1]), point(t[2]));
  if (!triangle.is_degenerate()) return CGAL::do_intersect(triangle, cube);
  for (int i = 0; i < 3; ++i) {
    const Kernel::Point_3 p = point(t[size_t(i)]), q = point(t[size_t((i + 1) % 3)]);
    if (p == q ? !cube.has_on_unbounded_side(p) : CGAL::do_intersect(Kernel::Segment_3(p, q), cube))
      return true;
  }
  return false;
}

// A triangle of one of the kinds that break tests of triangles and boxes; float coordinates, as scenes have
// them.
TestTriangle hardTriangle(std::mt19937_64& random) {
  const uint64_t kind = random() % 10;
  std::array<glm::vec3, 3> t;
  for (glm::vec3& p : t) {
    for (int axis = 0; axis < 3; ++axis) {
      switch (kind) {
        case 0:
          p[axis] = number(random, -1, 1);
          break;  // about a voxel
        case 1:
          p[axis] = number(random, -6, 6);
          break;  // several
        case 2:
          p[axis] = whole(random, -3, 3);
          break;  // on corners
        case 3:
          p[axis] = whole(random, -6, 6) / 2;
          break;  // on corners and middles
        case 4:
          p[axis] = whole(random, -3, 3) + whole(random, -1, 1) * 0x1p-22f;
          break;  // next to corners
        case 5:
          p[axis] = whole(random, -2, 2) + whole(random, -1, 1) * 0x1p-70f;
          break;  // specks about 0
        case 6:
          p[axis] = axis == 1 ? whole(random, -1, 1) * 1e-17f : number(random, -6, 6);
          break;  // a floor's noise
        case 7:
          p[axis] = axis == 2 ? whole(random, -1, 1) : number(random, -4, 4);
          break;  // in a plane, or nearly
        case 8:
          p[axis] = number(random, -0.01, 0.01) + (axis == 0 ? 8388600.f : -20000.f);
          break;  // far
        default:
          p[axis] = number(random, -8, 8);
          break;  // slivers: below
      }
    }
  }
  if (kind == 9)
    t[2] = t[0] + (t[1] - t[0]) * number(random, 0, 1) + glm::vec3(whole(random, -1, 1) * 0x1p-18f);
  if (random() % 16 == 0) t[2] = t[random() % 2];  // a segment
  return {glm::dvec3(t[0]), glm::dvec3(t[1]), glm::dvec3(t[2])};
}

std::set<std::array<int, 3>> voxelsOf(const TestTriangle& t, const VoxelBox& within) {
  std::set<std::array<int, 3>> voxels;
  TriangleRows rows(t);
  rows.visit(within, [&](int y, int z, int first, int last) {
    for (int x = first; x <= last; ++x) EXPECT_TRUE(voxels.insert({x, y, z}).second);
  });
  return voxels;
}

VoxelBox everything() {
  return {glm::ivec3(-(1 << 29)), glm::ivec3(1 << 29)};
}

// Right: the voxels of a triangle are those whose closed cube has a point in common with it.
// SIGHTLINE_VOXEL_TRIANGLES: how many triangles are tried.
TEST(TriangleRows, AreTheVoxelsThatMeetTheTriangle) {
  const char* wanted = std::getenv("SIGHTLINE_VOXEL_TRIANGLES");
  const int triangles = wanted == nullptr ? 3000 : std::atoi(wanted);
  std::mt19937_64 random(3);
  uint64_t voxels = 0, left_out = 0;
  for (int i = 0; i < triangles; ++i) {
    const TestTriangle t = hardTriangle(random);
    const auto found = voxelsOf(t, everything());
    voxels += found.size();
    const glm::ivec3 low(glm::floor(glm::min(t[0], glm::min(t[1], t[2]))) - 2.0);
    const glm::ivec3 high(glm::ceil(glm::max(t[0], glm::max(t[1], t[2]))) + 1.0);
    uint64_t seen = 0;
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          const bool is_in = found.contains({x, y, z});
          seen += is_in;
          left_out += !is_in;
          // Nothing outside of the triangle's own box needs rationals.
          ASSERT_EQ(is_in, meetsExactly(t, {x, y, z}))
              << "triangle " << i << ", voxel " << x << ' ' << y << ' ' << z;
        }
      }
    }
    ASSERT_EQ(seen, found.size()) << "triangle " << i;
  }
  EXPECT_GT(voxels, uint64_t(triangles) * 5);
  EXPECT_GT(left_out, voxels);
}

TEST(TriangleRows, DoNotDependOnTheOrderOfCornersOrTheBox) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 3000; ++i) {
    const TestTriangle t = hardTriangle(random);
    const auto all = voxelsOf(t, everything());
    ASSERT_EQ(voxelsOf({t[1], t[2], t[0]}, everything()), all) << i;
    ASSERT_EQ(voxelsOf({t[2], t[1], t[0]}, everything()), all) << i;
    const glm::ivec3 middle(glm::floor((t[0] + t[1] + t[2]) / 3.0));
    const VoxelBox part{middle - 2, middle + 1};
    std::set<std::array<int, 3>> expected;
    for (const auto& v : all) {
      const glm::ivec3 place(v[0], v[1], v[2]);
      if (glm::all(glm::lessThanEqual(part.low, place)) && glm::all(glm::lessThanEqual(place, part.high)))
        expected.insert(v);
    }
    ASSERT_EQ(voxelsOf(t, part), expected) << i;
  }
}

// A part of a surface of normal n and area A crosses about (|nx| + |ny| + |nz|) A voxels, and its border some
// more.
TEST(TriangleRows, FollowThePlaneLaw) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 30; ++i) {
    glm::dvec3 u, v;
    for (int axis = 0; axis < 3; ++axis) {
      u[axis] = number(random, -1, 1);
      v[axis] = number(random, -1, 1);
    }
    u = glm::normalize(u);
    v = glm::normalize(v - u * glm::dot(u, v));
    const double side = 400;
    const TestTriangle t{glm::dvec3(0.3), glm::dvec3(0.3) + side * u, glm::dvec3(0.3) + side * v};
    uint64_t count = 0;
    TriangleRows rows(t);
    rows.visit(everything(), [&](int, int, int first, int last) { count += uint64_t(last - first + 1); });
    const glm::dvec3 normal = glm::abs(glm::cross(u, v));
    const double expected = (normal.x + normal.y + normal.z) * side * side / 2;
    EXPECT_GT(double(count), expected);
    EXPECT_LT(double(count), expected + 4 * 3.5 * side);
  }
}

}  // namespace
}  // namespace sightline
