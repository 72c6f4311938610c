// Based on: K. Museth, VDB: High-Resolution Sparse Volumes with Dynamic Topology, 2013. Its leaves are as
// large as our bricks, and lie where these do.
#include "core/export/voxel_export.h"

#ifdef SL_HAVE_OPENVDB
#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <xxhash.h>

#include <sstream>

#include "core/base/error.h"
#include "core/io/file_io.h"
#else
#include "core/base/error.h"
#endif

namespace sightline {

#ifdef SL_HAVE_OPENVDB

namespace {

/// Voxels in the order of OpenVDB's leaf: z fastest, then y, then x.
void fillLeaf(openvdb::FloatTree::LeafNodeType& leaf, const VoxelBrick& brick) {
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      for (int x = 0; x < kBrickSide; ++x) {
        if (brick.contains(x, y, z)) leaf.setValueOn(openvdb::Index(z + 8 * y + 64 * x), 1.0f);
      }
    }
  }
}

/// OpenVDB draws a new identifier for each file: put the hash of the rest in its place.
void fixIdentifier(std::string& bytes) {
  constexpr size_t kStart = 21, kLength = 36;  // behind magic, three versions, and whether there are offsets
  const auto isIdentifier = [&] {
    if (bytes.size() < kStart + kLength) return false;
    for (const size_t dash : {8, 13, 18, 23}) {
      if (bytes[kStart + dash] != '-') return false;
    }
    return true;
  };
  if (!isIdentifier()) throw Error("OpenVDB writes another header than expected");
  bytes.replace(kStart, kLength, kLength, '0');
  const std::string digits = fmt::format("{:016x}{:016x}", XXH3_64bits(bytes.data(), bytes.size()),
                                         XXH3_64bits_withSeed(bytes.data(), bytes.size(), 1));
  bytes.replace(kStart, kLength,
                fmt::format("{}-{}-{}-{}-{}", digits.substr(0, 8), digits.substr(8, 4), digits.substr(12, 4),
                            digits.substr(16, 4), digits.substr(20, 12)));
}

}  // namespace

bool canSaveVdb() {
  return true;
}

void saveVdb(const VoxelGrid& grid, const glm::dvec3& offset, const std::filesystem::path& file) {
  openvdb::initialize();
  const auto volume = openvdb::FloatGrid::create(0.0f);
  volume->setName("density");
  volume->setGridClass(openvdb::GRID_FOG_VOLUME);
  volume->setSaveFloatAsHalf(true);
  const double size = grid.lattice.voxelSize();
  const auto transform = openvdb::math::Transform::createLinearTransform(size);
  transform->postTranslate(openvdb::Vec3d(offset.x, offset.y, offset.z) + openvdb::Vec3d(size / 2));
  volume->setTransform(transform);
  for (const VoxelBlock& block : grid.blocks) {
    for (const VoxelBrick& brick : block.bricks) {
      const glm::ivec3 low =
          block.place * kBlockSide +
          kBrickSide * glm::ivec3(brick.place & 7, (brick.place >> 3) & 7, brick.place >> 6);
      fillLeaf(*volume->tree().touchLeaf({low.x, low.y, low.z}), brick);
    }
  }
  std::ostringstream stream(std::ios::binary);
  openvdb::io::Stream(stream).write(openvdb::GridCPtrVec{volume});
  std::string bytes = std::move(stream).str();
  fixIdentifier(bytes);
  saveText(bytes, file);
}

#else

bool canSaveVdb() {
  return false;
}

void saveVdb(const VoxelGrid&, const glm::dvec3&, const std::filesystem::path& file) {
  throw Error(file.string() +
              ": this program was built without OpenVDB: install libopenvdb-dev and build again, or "
              "write glb or ply");
}

#endif

}  // namespace sightline
