#include "core/voxel/separating_rows.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Segment_3.h>
#include <CGAL/Triangle_3.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/voxel/voxelize.h"
#include "tests/voxel/random_numbers.h"

namespace sightline {
namespace {

using ShiftKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using SeparationTriangle = std::array<glm::dvec3, 3>;
using SeparationPlace = std::array<int, 3>;
using SeparationSet = std::set<SeparationPlace>;

constexpr Separation kBothSeparations[] = {Separation::k26, Separation::k6};

VoxelBox wholeLattice() {
  return {glm::ivec3(-(1 << 29)), glm::ivec3(1 << 29)};
}

SeparationSet separatingVoxels(const SeparationTriangle& t, Separation separation,
                               const VoxelBox& within = wholeLattice()) {
  SeparationSet voxels;
  SeparatingRows rows(t, separation);
  rows.visit(within, [&](int y, int z, int first, int last) {
    for (int x = first; x <= last; ++x) voxels.insert({x, y, z});
  });
  return voxels;
}

SeparationSet separatingVoxels(const std::vector<SeparationTriangle>& mesh, Separation separation) {
  SeparationSet voxels;
  for (const SeparationTriangle& t : mesh) voxels.merge(separatingVoxels(t, separation));
  return voxels;
}

SeparationSet meetingVoxels(const SeparationTriangle& t) {
  SeparationSet voxels;
  TriangleRows rows(t);
  rows.visit(wholeLattice(), [&](int y, int z, int first, int last) {
    for (int x = first; x <= last; ++x) voxels.insert({x, y, z});
  });
  return voxels;
}

// e^power for an e that is less than all that differences and products of these tests' coordinates can make.
ShiftKernel::FT tinyShift(int power) {
  ShiftKernel::FT e = 1;
  for (int i = 0; i < power; ++i) e *= ShiftKernel::FT(0x1p-450) * ShiftKernel::FT(0x1p-450);
  return e;
}

ShiftKernel::Point_3 shifted(const glm::dvec3& p, bool shifts) {
  static const ShiftKernel::FT x = tinyShift(1), y = tinyShift(2), z = tinyShift(3);
  if (!shifts) return {p.x, p.y, p.z};
  return {ShiftKernel::FT(p.x) + x, ShiftKernel::FT(p.y) + y, ShiftKernel::FT(p.z) + z};
}

// Whether the triangle meets one of the voxel's targets, by CGAL's exact test of segments, with a shift that
// is no symbol but a number.
bool meetsTargets(const SeparationTriangle& t, Separation separation, const SeparationPlace& voxel,
                  bool shifts) {
  const auto point = [](const glm::dvec3& p) { return ShiftKernel::Point_3(p.x, p.y, p.z); };
  const ShiftKernel::Triangle_3 triangle(point(t[0]), point(t[1]), point(t[2]));
  if (triangle.is_degenerate()) return false;
  const glm::dvec3 centre = glm::dvec3(voxel[0], voxel[1], voxel[2]) + 0.5;
  const std::vector<glm::dvec3> along =
      separation == Separation::k6 ? std::vector<glm::dvec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
                                   : std::vector<glm::dvec3>{{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
  return std::any_of(along.begin(), along.end(), [&](const glm::dvec3& d) {
    return CGAL::do_intersect(triangle, ShiftKernel::Segment_3(shifted(centre - 0.5 * d, shifts),
                                                               shifted(centre + 0.5 * d, shifts)));
  });
}

// Kinds that make ties: corners on the lattice's corners, edges, faces and centres, and next to them.
SeparationTriangle tiedTriangle(std::mt19937_64& random) {
  const uint64_t kind = random() % 8;
  std::array<glm::vec3, 3> t;
  for (glm::vec3& p : t) {
    for (int axis = 0; axis < 3; ++axis) {
      const float on_lattice = whole(random, -3, 3), on_middles = whole(random, -5, 5) / 2;
      const float anywhere = number(random, -3, 3), step = whole(random, -1, 1);
      p[axis] = kind == 0   ? on_lattice
                : kind == 1 ? on_middles
                : kind == 2 ? anywhere
                : kind == 3 ? on_middles + step * 0x1p-22f
                : kind == 4 ? (axis == int(random() % 3) ? step * 0x1p-60f : on_lattice)
                : kind == 5 ? (axis == 1 ? step / 2 : anywhere)
                : kind == 6 ? number(random, -0.8, 0.8)
                            : anywhere;
    }
  }
  if (kind == 7) {
    const float share = number(random, 0, 1);
    t[2] = t[0] + (t[1] - t[0]) * share + glm::vec3(whole(random, -1, 1) * 0x1p-18f);
  }
  return {glm::dvec3(t[0]), glm::dvec3(t[1]), glm::dvec3(t[2])};
}

// Right: a voxel is in a triangle's set if the triangle meets one of its shifted targets.
// SIGHTLINE_VOXEL_TRIANGLES: how many triangles are tried.
TEST(SeparatingRows, AreTheVoxelsWhoseTargetsTheTriangleMeets) {
  const char* wanted = std::getenv("SIGHTLINE_VOXEL_TRIANGLES");
  const int triangles = wanted == nullptr ? 400 : std::atoi(wanted);
  std::mt19937_64 random(11);
  uint64_t in = 0, out = 0, ties = 0;
  for (int i = 0; i < triangles; ++i) {
    const SeparationTriangle t = tiedTriangle(random);
    const SeparationSet all = meetingVoxels(t);
    for (const Separation separation : kBothSeparations) {
      const SeparationSet found = separatingVoxels(t, separation);
      ASSERT_TRUE(std::includes(all.begin(), all.end(), found.begin(), found.end())) << i;
      for (const SeparationPlace& voxel : all) {
        const bool meets = meetsTargets(t, separation, voxel, true);
        ASSERT_EQ(found.contains(voxel), meets)
            << "triangle " << i << ", voxel " << voxel[0] << ' ' << voxel[1] << ' ' << voxel[2];
        in += meets;
        out += !meets;
        ties += meets != meetsTargets(t, separation, voxel, false);
      }
    }
  }
  EXPECT_GT(in, 2000u);
  EXPECT_GT(out, 2000u);
  EXPECT_GT(ties, 500u);
}

TEST(SeparatingRows, DoNotDependOnTheOrderOfCornersOrTheBox) {
  std::mt19937_64 random(12);
  for (int i = 0; i < 2000; ++i) {
    const SeparationTriangle t = tiedTriangle(random);
    for (const Separation separation : kBothSeparations) {
      const SeparationSet all = separatingVoxels(t, separation);
      ASSERT_EQ(separatingVoxels({t[1], t[2], t[0]}, separation), all) << i;
      ASSERT_EQ(separatingVoxels({t[2], t[1], t[0]}, separation), all) << i;
      const glm::ivec3 middle(glm::floor((t[0] + t[1] + t[2]) / 3.0));
      const VoxelBox part{middle - 2, middle};
      SeparationSet expected;
      for (const SeparationPlace& v : all) {
        const glm::ivec3 place(v[0], v[1], v[2]);
        if (glm::all(glm::lessThanEqual(part.low, place)) && glm::all(glm::lessThanEqual(place, part.high)))
          expected.insert(v);
      }
      ASSERT_EQ(separatingVoxels(t, separation, part), expected) << i;
    }
  }
}

// Cut at a point of an edge or of the inside, again and again.
void cutRandomly(const SeparationTriangle& t, int depth, std::mt19937_64& random,
                 std::vector<SeparationTriangle>& parts) {
  if (depth == 0) {
    parts.push_back(t);
    return;
  }
  const size_t a = random() % 3, b = (a + 1) % 3, c = (a + 2) % 3;
  if (random() % 2 == 0) {
    const glm::dvec3 middle = (t[a] + t[b]) / 2.0;
    cutRandomly({t[a], middle, t[c]}, depth - 1, random, parts);
    cutRandomly({middle, t[b], t[c]}, depth - 1, random, parts);
    return;
  }
  const glm::dvec3 inside = t[a] / 2.0 + (t[b] + t[c]) / 4.0;
  for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}}) {
    cutRandomly({t[p], t[q], inside}, depth - 1, random, parts);
  }
}

TEST(SeparatingRows, DependOnTheSurfaceNotOnHowItIsCut) {
  std::mt19937_64 random(13);
  for (int i = 0; i < 300; ++i) {
    SeparationTriangle t;
    for (glm::dvec3& p : t) {
      for (int axis = 0; axis < 3; ++axis) p[axis] = whole(random, -8, 8) / 2;
    }
    std::vector<SeparationTriangle> parts;
    cutRandomly(t, 4, random, parts);
    std::shuffle(parts.begin(), parts.end(), random);
    for (const Separation separation : kBothSeparations) {
      ASSERT_EQ(separatingVoxels(parts, separation), separatingVoxels(t, separation)) << i;
    }
  }
}

// A closed mesh: the faces of an octahedron, each cut in four, with corners moved to the places that `place`
// gives. Parts may pass through each other: what is inside is told by parity.
std::vector<SeparationTriangle> closedMesh(const std::function<glm::dvec3(const glm::dvec3&)>& place) {
  std::vector<SeparationTriangle> mesh;
  for (int octant = 0; octant < 8; ++octant) {
    const glm::dvec3 x(octant & 1 ? 1 : -1, 0, 0), y(0, octant & 2 ? 1 : -1, 0), z(0, 0, octant & 4 ? 1 : -1);
    const glm::dvec3 xy = (x + y) / 2.0, yz = (y + z) / 2.0, zx = (z + x) / 2.0;
    for (const SeparationTriangle& t :
         {SeparationTriangle{x, xy, zx}, {y, yz, xy}, {z, zx, yz}, {xy, yz, zx}}) {
      mesh.push_back({place(t[0]), place(t[1]), place(t[2])});
    }
  }
  return mesh;
}

// Whether the voxel's shifted centre is inside: it sees the mesh oddly often along x.
bool isInside(const std::vector<SeparationTriangle>& mesh, const glm::ivec3& voxel) {
  const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
  const ShiftKernel::Segment_3 ray(shifted(centre, true), shifted(centre + glm::dvec3(100, 0, 0), true));
  bool inside = false;
  for (const SeparationTriangle& t : mesh) {
    const auto point = [](const glm::dvec3& p) { return ShiftKernel::Point_3(p.x, p.y, p.z); };
    const ShiftKernel::Triangle_3 triangle(point(t[0]), point(t[1]), point(t[2]));
    if (!triangle.is_degenerate() && CGAL::do_intersect(triangle, ray)) inside = !inside;
  }
  return inside;
}

// Right: no path from a voxel inside to one outside avoids the set. Then no two neighbours that are not in it
// lie on different sides.
TEST(SeparatingRows, LetNoPathThroughAClosedSurface) {
  constexpr int kReach = 6;
  std::mt19937_64 random(14);
  uint64_t inside = 0;
  for (int i = 0; i < 12; ++i) {
    // On corners of the lattice, on middles too, anywhere.
    const double steps_a_voxel = i % 3 == 0 ? 1 : i % 3 == 1 ? 2 : 1 << 20;
    const double radius = number(random, 3, 5);
    std::map<std::array<double, 3>, glm::dvec3> placed;
    const auto mesh = closedMesh([&](const glm::dvec3& corner) {
      const auto [found, is_new] = placed.emplace(std::array{corner.x, corner.y, corner.z}, glm::dvec3(0));
      if (is_new) {
        for (int axis = 0; axis < 3; ++axis) {
          const double anywhere = glm::normalize(corner)[axis] * radius + number(random, -0.9, 0.9);
          found->second[axis] = std::round(anywhere * steps_a_voxel) / steps_a_voxel;
        }
      }
      return found->second;
    });
    const int side = 2 * kReach;
    std::vector<char> sides(size_t(side * side * side));
    const auto sideOf = [&](const glm::ivec3& v) -> char& {
      return sides[size_t((v.x + kReach) + side * ((v.y + kReach) + side * (v.z + kReach)))];
    };
    const auto visitAll = [&](const std::function<void(const glm::ivec3&)>& visit) {
      for (int z = -kReach; z < kReach; ++z) {
        for (int y = -kReach; y < kReach; ++y) {
          for (int x = -kReach; x < kReach; ++x) visit({x, y, z});
        }
      }
    };
    visitAll([&](const glm::ivec3& v) {
      sideOf(v) = isInside(mesh, v);
      inside += uint64_t(sideOf(v));
    });
    for (const Separation separation : kBothSeparations) {
      const SeparationSet set = separatingVoxels(mesh, separation);
      const auto isIn = [&](const glm::ivec3& v) { return set.contains({v.x, v.y, v.z}); };
      visitAll([&](const glm::ivec3& v) {
        if (isIn(v)) return;
        for (int step = 0; step < 27; ++step) {
          const glm::ivec3 to(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1), w = v + to;
          const int length = std::abs(to.x) + std::abs(to.y) + std::abs(to.z);
          if (length == 0 || (separation == Separation::k6 && length > 1)) continue;
          if (glm::any(glm::lessThan(w, glm::ivec3(-kReach))) ||
              glm::any(glm::greaterThanEqual(w, glm::ivec3(kReach))) || isIn(w))
            continue;
          EXPECT_EQ(sideOf(v), sideOf(w)) << "mesh " << i << ": a path from " << v.x << ' ' << v.y << ' '
                                          << v.z << " to " << w.x << ' ' << w.y << ' ' << w.z;
        }
      });
    }
  }
  EXPECT_GT(inside, 1000u);
}

// A part of a surface of normal n and area A is met by the targets of about max |ni| A voxels (6) or
// (|nx| + |ny| + |nz|) A (26), give or take its border.
TEST(SeparatingRows, FollowThePlaneLaw) {
  std::mt19937_64 random(15);
  for (int i = 0; i < 20; ++i) {
    glm::dvec3 u, v;
    for (int axis = 0; axis < 3; ++axis) {
      u[axis] = number(random, -1, 1);
      v[axis] = number(random, -1, 1);
    }
    u = glm::normalize(u);
    v = glm::normalize(v - u * glm::dot(u, v));
    const double side = 60;
    const SeparationTriangle t{glm::dvec3(0.3), glm::dvec3(0.3) + side * u, glm::dvec3(0.3) + side * v};
    const glm::dvec3 normal = glm::abs(glm::cross(u, v));
    for (const Separation separation : kBothSeparations) {
      const double width = separation == Separation::k6 ? std::max({normal.x, normal.y, normal.z})
                                                        : normal.x + normal.y + normal.z;
      EXPECT_NEAR(double(separatingVoxels(t, separation).size()), width * side * side / 2, 3.5 * side);
    }
  }
}

TEST(Voxelize, SeparatesAsItsTrianglesDo) {
  std::mt19937_64 random(16);
  Scene scene;
  std::vector<SeparationTriangle> triangles;
  for (uint32_t i = 0; i < 150; ++i) {
    glm::vec3 middle(0);
    for (int axis = 0; axis < 3; ++axis) middle[axis] = number(random, -40, 40);
    const float size = i % 10 == 0 ? 40 : 2;
    for (int corner = 0; corner < 3; ++corner) {
      glm::vec3 step(0);
      for (int axis = 0; axis < 3; ++axis) step[axis] = number(random, -size, size);
      scene.positions.push_back(middle + step);
    }
    scene.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    const auto corners = scene.corners(i);
    triangles.push_back(
        {2.0 * glm::dvec3(corners[0]), 2.0 * glm::dvec3(corners[1]), 2.0 * glm::dvec3(corners[2])});
  }
  scene.objects.push_back({"all", 0, 150});
  for (const Separation separation : kBothSeparations) {
    const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(0.5), .separation = separation});
    const VoxelLookup lookup(grid);
    const SeparationSet expected = separatingVoxels(triangles, separation);
    EXPECT_EQ(grid.count(), expected.size());
    for (const SeparationPlace& v : expected) ASSERT_TRUE(lookup.contains({v[0], v[1], v[2]}));
    for (const VoxelBlock& block : grid.blocks) {
      EXPECT_FALSE(block.bricks.empty());
      EXPECT_FALSE(block.triangles.empty());
    }
  }
}

}  // namespace
}  // namespace sightline
