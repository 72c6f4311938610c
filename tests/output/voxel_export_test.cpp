// Voxels in other programs' files: read back, they are the same set.
#include "core/export/voxel_export.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/formats/load_scene.h"
#include "tests/scene/files.h"

#ifdef SL_HAVE_OPENVDB
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#endif

namespace sightline {
namespace {

/// A few voxels about a corner of blocks, of side 0.5.
VoxelGrid someVoxels(uint64_t seed) {
  std::mt19937_64 random(seed);
  VoxelGrid grid;
  grid.lattice.exponent = -1;
  for (const glm::ivec3& place : {glm::ivec3(-1, -1, -1), {0, 0, 0}, {1, 0, 0}}) {
    BlockBits bits;
    for (int i = 0; i < 200; ++i) {
      const auto x = int(random() % 64), y = int(random() % 64), z = int(random() % 64);
      bits.row(y, z) |= uint64_t{1} << x;
    }
    for (int y = 8; y < 16; ++y) bits.row(y, 9) = ~uint64_t{0};
    grid.blocks.emplace_back();
    grid.blocks.back().place = place;
    grid.blocks.back().bricks = bits.bricks();
  }
  return grid;
}

std::multiset<std::array<std::array<double, 3>, 3>> trianglesOfScene(const Scene& scene) {
  std::multiset<std::array<std::array<double, 3>, 3>> all;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    std::array<std::array<double, 3>, 3> places{};
    for (size_t k = 0; k < 3; ++k) {
      const glm::dvec3 p = glm::dvec3(scene.corners(id)[k]) + scene.offset;
      places[k] = {p.x, p.y, p.z};
    }
    std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
    all.insert(places);
  }
  return all;
}

TEST(VoxelPly, HoldsTheFaces) {
  const test::Folder folder;
  const VoxelGrid grid = someVoxels(1);
  for (const FaceMerging merging : {FaceMerging::kNone, FaceMerging::kBlocks}) {
    for (const glm::dvec3 offset : {glm::dvec3(0), glm::dvec3(4'000'000, -7, 1)}) {
      savePly(voxelMesh(grid, merging), offset, folder / "a.ply");
      Scene expected = voxelScene(grid, merging);
      expected.offset = offset;
      EXPECT_EQ(trianglesOfScene(loadScene(folder / "a.ply")), trianglesOfScene(expected));
    }
  }
}

#ifdef SL_HAVE_OPENVDB
TEST(VoxelVdb, HoldsTheSet) {
  const test::Folder folder;
  const VoxelGrid grid = someVoxels(2);
  const glm::dvec3 offset(100, 0, -3);
  saveVdb(grid, offset, folder / "a.vdb");
  saveVdb(grid, offset, folder / "b.vdb");
  EXPECT_EQ(test::readText(folder / "a.vdb"), test::readText(folder / "b.vdb"));
  openvdb::initialize();
  openvdb::io::File file((folder / "a.vdb").string());
  file.open();
  const auto volume = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
  EXPECT_EQ(volume->activeVoxelCount(), grid.count());
  const VoxelLookup lookup(grid);
  for (auto voxel = volume->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Coord at = voxel.getCoord();
    ASSERT_TRUE(lookup.contains({at.x(), at.y(), at.z()})) << at;
    ASSERT_EQ(*voxel, 1.0f);
    const openvdb::Vec3d middle = volume->transform().indexToWorld(at);
    ASSERT_EQ(middle, openvdb::Vec3d(100 + (at.x() + 0.5) / 2, (at.y() + 0.5) / 2, -3 + (at.z() + 0.5) / 2));
  }
  EXPECT_TRUE(canSaveVdb());
}
#else
TEST(VoxelVdb, SaysWhatIsMissing) {
  EXPECT_FALSE(canSaveVdb());
  EXPECT_NE(test::errorOf([] { saveVdb(someVoxels(2), {}, "a.vdb"); }).find("libopenvdb-dev"),
            std::string::npos);
}
#endif

}  // namespace
}  // namespace sightline
