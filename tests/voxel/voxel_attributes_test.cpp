#include "core/voxel/voxel_attributes.h"

#include <CGAL/Exact_rational.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "core/voxel/voxelize.h"

namespace sightline {
namespace {

using AreaRational = CGAL::Exact_rational;
using AreaPoint = std::array<AreaRational, 3>;

// Of what of the triangle is in the voxel's closed cube, twice its area as a vector: cut in rationals.
glm::dvec3 exactArea(const std::array<glm::dvec3, 3>& t, const glm::ivec3& voxel) {
  std::vector<AreaPoint> polygon;
  for (const glm::dvec3& p : t) polygon.push_back({AreaRational(p.x), AreaRational(p.y), AreaRational(p.z)});
  for (int plane = 0; plane < 6; ++plane) {
    const auto axis = size_t(plane / 2);
    const int sign = plane % 2 == 0 ? 1 : -1;
    const AreaRational at = voxel[plane / 2] + plane % 2;
    std::vector<AreaPoint> part;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const AreaPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const AreaRational from = sign * (p[axis] - at), to = sign * (q[axis] - at);
      if (from >= 0) part.push_back(p);
      if (from * to < 0) {
        const AreaRational share = from / (from - to);
        part.push_back(
            {p[0] + (q[0] - p[0]) * share, p[1] + (q[1] - p[1]) * share, p[2] + (q[2] - p[2]) * share});
      }
    }
    polygon = part;
  }
  AreaRational sum[3] = {0, 0, 0};
  for (size_t i = 2; i < polygon.size(); ++i) {
    AreaRational u[3], v[3];
    for (size_t a = 0; a < 3; ++a) {
      u[a] = polygon[i - 1][a] - polygon[0][a];
      v[a] = polygon[i][a] - polygon[0][a];
    }
    for (size_t a = 0; a < 3; ++a)
      sum[a] += u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
  }
  return {CGAL::to_double(sum[0]), CGAL::to_double(sum[1]), CGAL::to_double(sum[2])};
}

// Triangles of one to some voxels in seven objects, many of them through the same voxels; some in planes of
// the lattice, some doubled and turned, some segments.
Scene attributeScene() {
  std::mt19937_64 random(21);
  const auto number = [&](double reach) { return float((double(random() >> 11) * 0x1p-52 - 1) * reach); };
  Scene scene;
  constexpr uint32_t kObjects = 7, kTriangles = 20;
  for (uint32_t object = 0; object < kObjects; ++object) {
    for (uint32_t i = 0; i < kTriangles; ++i) {
      std::array<glm::vec3, 3> t;
      glm::vec3 middle(0);
      for (int axis = 0; axis < 3; ++axis) middle[axis] = number(4);
      for (glm::vec3& p : t) {
        for (int axis = 0; axis < 3; ++axis) p[axis] = middle[axis] + number(i % 5 == 0 ? 6 : 1.5);
        if (i % 4 == 1) p.y = std::round(middle.y);
        if (i % 4 == 2) p = glm::round(p * 2.f) / 2.f;
      }
      if (i % 10 == 9) t[2] = t[1];
      for (const glm::vec3& p : t) scene.positions.push_back(p);
      const auto first = uint32_t(scene.positions.size()) - 3;
      scene.triangles.emplace_back(first, first + 1, first + 2);
    }
    scene.objects.push_back({"o", object * kTriangles, kTriangles});
  }
  return scene;
}

// Right: a voxel's normal is the mean by area of what of the triangles is in it, and its object the one with
// most of that.
TEST(VoxelAttributes, AreThoseOfTheAreasInTheVoxel) {
  const Scene scene = attributeScene();
  for (const Separation separation : {Separation::kConservative, Separation::k6}) {
    const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(1),
                                            .separation = separation,
                                            .attributes = {.normals = true, .objects = true}});
    uint64_t normals = 0, objects = 0, none = 0;
    for (const VoxelBlock& block : grid.blocks) {
      ASSERT_EQ(block.normals.size(), block.count());
      ASSERT_EQ(block.objects.size(), block.count());
      const VoxelRanks ranks(block);
      uint32_t rank = 0;
      for (const VoxelBrick& brick : block.bricks) {
        for (int bit = 0; bit < 512; ++bit) {
          if (!brick.contains(bit & 7, (bit >> 3) & 7, bit >> 6)) continue;
          const glm::ivec3 place(8 * (brick.place & 7) + (bit & 7),
                                 8 * ((brick.place >> 3) & 7) + (bit >> 3 & 7),
                                 8 * (brick.place >> 6) + (bit >> 6));
          ASSERT_EQ(ranks.of(place.x, place.y, place.z), rank);
          const glm::ivec3 voxel = kBlockSide * block.place + place;
          glm::dvec3 normal(0);
          double area = 0;
          std::map<uint32_t, double> areas;
          for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
            const auto c = scene.corners(id);
            const std::array<glm::dvec3, 3> t{glm::dvec3(c[0]), glm::dvec3(c[1]), glm::dvec3(c[2])};
            const glm::dvec3 low = glm::min(t[0], glm::min(t[1], t[2])),
                             high = glm::max(t[0], glm::max(t[1], t[2]));
            if (glm::any(glm::lessThan(high, glm::dvec3(voxel))) ||
                glm::any(glm::greaterThan(low, glm::dvec3(voxel + 1))))
              continue;
            const glm::dvec3 part = exactArea(t, voxel);
            normal += part;
            area += glm::length(part);
            areas[id / 20] += glm::length(part);
          }
          const double most = std::max_element(areas.begin(), areas.end(), [](auto& a, auto& b) {
                                return a.second < b.second;
                              })->second;
          // Not where two are next to each other: rounding may decide.
          const auto rivals = std::count_if(areas.begin(), areas.end(),
                                            [&](auto& a) { return a.second > most * (1 - 1e-9); });
          ASSERT_TRUE(areas.contains(block.objects[rank]) || area == 0);
          EXPECT_GE(areas[block.objects[rank]], most * (1 - 1e-9)) << rank;
          objects += rivals == 1;
          if (glm::length(normal) > 1e-3 * area && area > 0) {
            const glm::dvec3 found = unpackNormal(block.normals[rank]), expected = glm::normalize(normal);
            for (int axis = 0; axis < 3; ++axis) {
              ASSERT_NEAR(found[axis], expected[axis], 0.5 / 511 + 1e-9) << voxel.x << ' ' << voxel.y;
            }
            ++normals;
          } else if (area == 0) {
            EXPECT_EQ(block.normals[rank], 0u);
            ++none;
          }
          ++rank;
        }
      }
    }
    EXPECT_GT(normals, 300u);
    EXPECT_GT(objects, 300u);
    EXPECT_TRUE(none > 5u || separation != Separation::kConservative) << none;
  }
}

TEST(VoxelAttributes, SayNothingWhereSidesCancelAndTheLowerObjectOfTwo) {
  Scene scene;
  for (const float x : {0.25f, 0.75f}) {
    for (const glm::vec3& p : {glm::vec3(x, 0.25f, 0.25f), {x, 0.75f, 0.25f}, {x, 0.25f, 0.75f}})
      scene.positions.push_back(p);
  }
  scene.triangles = {{0, 1, 2}, {3, 5, 4}};
  scene.objects = {{"a", 0, 1}, {"b", 1, 1}};
  VoxelizeOptions options{.lattice = latticeOf(1), .attributes = {.normals = true, .objects = true}};
  VoxelGrid grid = voxelize(scene, options);
  ASSERT_EQ(grid.count(), 1u);
  EXPECT_EQ(grid.blocks[0].normals, std::vector<uint32_t>{0});
  EXPECT_EQ(grid.blocks[0].objects, std::vector<uint32_t>{0});
  scene.positions[4].y = 0.875f;
  grid = voxelize(scene, options);
  EXPECT_EQ(grid.blocks[0].normals, std::vector<uint32_t>{packNormal({-1, 0, 0})});
  EXPECT_EQ(grid.blocks[0].objects, std::vector<uint32_t>{1});
}

TEST(VoxelAttributes, AreTheSameOnAnyThreadsAndMemory) {
  const Scene scene = attributeScene();
  VoxelizeOptions options{.lattice = latticeOf(0.03125), .attributes = {.normals = true, .objects = true}};
  const VoxelGrid grid = voxelize(scene, options);
  EXPECT_GT(grid.blocks.size(), 10u);
  for (const size_t threads : {1, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    options.memory = threads;
    EXPECT_EQ(voxelize(scene, options).blocks, grid.blocks);
  }
}

TEST(VoxelAttributes, PackDirectionsToTenBitsAnAxis) {
  EXPECT_EQ(packNormal({0, 0, 0}), 0u);
  EXPECT_EQ(packNormal({5, 0, 0}), 511u);
  EXPECT_EQ(packNormal({0, -1e-30, 0}), (1024u - 511u) << 10);
  EXPECT_EQ(unpackNormal(packNormal({0, 0, -3})), glm::dvec3(0, 0, -1));
}

}  // namespace
}  // namespace sightline
