// Faces of a set of voxels: all sides between what is in it and what is not, each once, seen from outside.
#include "core/voxel/voxel_faces.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <random>
#include <set>
#include <tuple>

#include "core/base/error.h"
#include "core/voxel/voxelize.h"

namespace sightline {
namespace {

using FacePlace = std::array<int, 3>;
using Side = std::tuple<FacePlace, int, bool>;  // of a voxel: axis, up it

VoxelGrid gridOf(const std::set<FacePlace>& places, int exponent) {
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) { return placeBefore(a, b); };
  std::map<glm::ivec3, BlockBits, decltype(before)> blocks(before);
  for (const auto& [x, y, z] : places) {
    blocks[{x >> 6, y >> 6, z >> 6}].row(y & 63, z & 63) |= uint64_t{1} << (x & 63);
  }
  VoxelGrid grid;
  grid.lattice.exponent = exponent;
  for (const auto& [place, bits] : blocks) {
    grid.blocks.emplace_back();
    grid.blocks.back().place = place;
    grid.blocks.back().bricks = bits.bricks();
  }
  return grid;
}

/// Scattered voxels and solid boxes about a corner of eight blocks, some of which are full.
std::set<FacePlace> randomPlaces(uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto number = [&](int low, int high) { return low + int(random() % uint64_t(high - low + 1)); };
  std::set<FacePlace> places;
  for (int i = 0; i < 300; ++i) {
    const int x = number(-70, 70), y = number(-9, 9), z = number(-70, 70);
    places.insert({x, y, z});
  }
  for (int box = 0; box < 4; ++box) {
    const int x = number(-66, 50), y = number(-66, 50), z = number(-66, 50);
    const int wide = number(1, 20), high = number(1, 20), deep = number(1, 20);
    for (int i = 0; i < wide; ++i) {
      for (int j = 0; j < high; ++j) {
        for (int k = 0; k < deep; ++k) places.insert({x + i, y + j, z + k});
      }
    }
  }
  if (seed % 3 == 0) {
    for (int i = 0; i < 64 * 64 * 64; ++i) places.insert({i & 63, (i >> 6) & 63, i >> 12});
  }
  return places;
}

std::set<Side> sidesOf(const std::set<FacePlace>& places) {
  std::set<Side> sides;
  for (const FacePlace& place : places) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool high : {false, true}) {
        FacePlace beside = place;
        beside[size_t(axis)] += high ? 1 : -1;
        if (!places.contains(beside)) sides.insert({place, axis, high});
      }
    }
  }
  return sides;
}

class VoxelFaces : public testing::TestWithParam<std::tuple<uint64_t, FaceMerging>> {};

TEST_P(VoxelFaces, AreAllSidesOfTheSetAndEachOnce) {
  const auto [seed, merging] = GetParam();
  const std::set<FacePlace> places = randomPlaces(seed);
  std::set<Side> found;
  const std::vector<VoxelFace> faces = facesOf(gridOf(places, 0), merging);
  for (const VoxelFace& face : faces) {
    const int u = face.axis == 0 ? 1 : 0, v = face.axis == 2 ? 1 : 2;
    ASSERT_GE(face.size.x, 1);
    ASSERT_GE(face.size.y, 1);
    if (merging == FaceMerging::kNone) {
      ASSERT_EQ(face.size, glm::ivec2(1));
    }
    for (int i = 0; i < face.size.x; ++i) {
      for (int j = 0; j < face.size.y; ++j) {
        FacePlace place = {face.low.x, face.low.y, face.low.z};
        place[size_t(face.axis)] -= face.high ? 1 : 0;
        place[size_t(u)] += i;
        place[size_t(v)] += j;
        ASSERT_TRUE(found.insert({place, face.axis, face.high}).second) << "twice";
      }
    }
  }
  EXPECT_EQ(found, sidesOf(places));
  if (merging == FaceMerging::kBlocks) {
    EXPECT_LT(faces.size(), found.size());
  }
}

TEST_P(VoxelFaces, BoundTheSet) {
  const auto [seed, merging] = GetParam();
  const std::set<FacePlace> places = randomPlaces(seed);
  const VoxelGrid grid = gridOf(places, -2);
  const Scene scene = voxelScene(grid, merging);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  double volume = 0, area = 0;
  for (const glm::uvec3& t : scene.triangles) {
    const glm::dvec3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
    volume += glm::dot(a, glm::cross(b, c));
    area += glm::length(glm::cross(b - a, c - a)) / 2;
    for (int k = 0; k < 3; ++k) {
      ++edges[{t[k], t[(k + 1) % 3]}];
      --edges[{t[(k + 1) % 3], t[k]}];
    }
  }
  EXPECT_EQ(volume, 6 * double(places.size()) / 64) << "not that of the voxels: inside out, or open";
  EXPECT_EQ(area, double(sidesOf(places).size()) / 16);
  if (merging == FaceMerging::kNone) {
    for (const auto& [edge, sum] : edges) ASSERT_EQ(sum, 0) << "open";
  }
  std::set<std::array<float, 3>> corners;
  for (const glm::vec3& p : scene.positions)
    ASSERT_TRUE(corners.insert({p.x, p.y, p.z}).second) << "not shared";
}

INSTANTIATE_TEST_SUITE_P(Sets, VoxelFaces,
                         testing::Combine(testing::Values(0ull, 1ull, 2ull, 3ull, 4ull, 5ull),
                                          testing::Values(FaceMerging::kNone, FaceMerging::kBlocks)));

TEST(VoxelMesh, IsTheSameOnAnyThreads) {
  const VoxelGrid grid = gridOf(randomPlaces(7), -1);
  const VoxelMesh mesh = voxelMesh(grid, FaceMerging::kBlocks);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const VoxelMesh again = voxelMesh(grid, FaceMerging::kBlocks);
    EXPECT_EQ(again.positions, mesh.positions);
    EXPECT_EQ(again.faces, mesh.faces);
  }
}

/// A wall's 4096 sides are one face, and a full block has six.
TEST(VoxelMesh, MergesWholeWalls) {
  std::set<FacePlace> places;
  for (int i = 0; i < 64 * 64 * 64; ++i) places.insert({i & 63, (i >> 6) & 63, i >> 12});
  EXPECT_EQ(voxelMesh(gridOf(places, 0), FaceMerging::kBlocks).faces.size(), 6u);
  EXPECT_EQ(voxelMesh(gridOf(places, 0), FaceMerging::kNone).faces.size(), 6u * 4096);
}

TEST(VoxelMesh, SaysWhatItCannotHold) {
  EXPECT_THROW(voxelMesh(VoxelGrid{}, FaceMerging::kNone), Error);
  EXPECT_THROW(voxelMesh(gridOf({{(1 << 24) + 64, 0, 0}}, 0), FaceMerging::kNone), Error);
  EXPECT_EQ(voxelMesh(gridOf({{(1 << 24) - 1, 0, -(1 << 24)}}, 0), FaceMerging::kNone).positions.size(), 8u);
}

}  // namespace
}  // namespace sightline
