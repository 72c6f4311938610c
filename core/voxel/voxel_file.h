#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/io/byte_stream.h"
#include "core/io/file_io.h"
#include "core/pvs/checksum.h"
#include "core/voxel/pyramid.h"
#include "core/voxel/voxel_grid.h"
#include "core/voxel/voxelize.h"

// Voxels in a file: .slv, as docs/slv-format.md specifies it.
namespace sightline {

inline constexpr uint8_t kVoxelMagic[8] = {0x89, 'S', 'L', 'V', 'O', 'X', '\r', '\n'};
inline constexpr uint32_t kVoxelVersion = 1;

/// What a file's voxels are of.
struct VoxelHead {
  Lattice lattice;  ///< of the finest level
  Separation separation = Separation::kConservative;
  bool has_triangles = false;   ///< the finest level's blocks have ids
  bool has_normals = false;     ///< and normals a voxel
  bool has_objects = false;     ///< and objects
  bool is_solid = false;        ///< what is inside of solids is in the set, too
  uint64_t scene_hash = 0;      ///< hashScene
  uint32_t triangle_count = 0;  ///< of the scene
  glm::dvec3 offset{0.0};  ///< Scene::offset: a voxel's place in the scene's file is its place here and this
  bool operator==(const VoxelHead&) const = default;
};

VoxelHead headOf(const Scene& scene, const VoxelizeOptions& options);

/// A file's content: the finest level first, each next one coarser(), the last a root.
struct VoxelFile {
  VoxelHead head;
  std::vector<VoxelGrid> levels;
};

/// Counts of a level.
struct VoxelLevelCounts {
  uint64_t voxels = 0, blocks = 0, bricks = 0;
  uint64_t geometry_bytes = 0, triangle_bytes = 0, attribute_bytes = 0;  ///< in the file
};

/// Writes a .slv file block by block: the finest level's as they come, coarser ones of them, which are kept
/// in memory (a third of the finest level's bricks, of surfaces) until finish(). The file appears under its
/// name only then; without finish() nothing is left of it. All throw Error.
class VoxelWriter {
 public:
  VoxelWriter(const std::filesystem::path& file, const VoxelHead& head);
  ~VoxelWriter();
  /// In order (placeBefore).
  void add(VoxelBlock&& block);
  /// The counts of each level, the finest first.
  std::vector<VoxelLevelCounts> finish();

 private:
  void put(const Bytes& bytes);
  void putChunk(size_t level, std::vector<VoxelBlock>& blocks);

  OutputFile output_;
  VoxelHead head_;
  Checksum checksum_;
  uint32_t chunks_ = 0;
  std::vector<VoxelBlock> pending_;  ///< of the finest level, not yet written
  std::unique_ptr<CoarserBlocks> coarser_;
  std::vector<VoxelGrid> coarse_;  ///< the level after the finest, and on
  std::vector<VoxelLevelCounts> counts_;
};

/// Reads a file. Throws Error that names the file, the place and what is wrong: no voxel file, another
/// version, damage.
VoxelFile loadVoxels(const std::filesystem::path& file);

/// A file's content in memory; `file` is for messages.
VoxelFile parseVoxels(std::span<const uint8_t> bytes, const std::filesystem::path& file);

/// Whether a file begins as voxel files do, or has their extension.
bool isVoxelFile(const std::filesystem::path& file);

/// Throws Error (exit code 2) if the voxels are not of the scene with this hash.
void requireScene(const VoxelHead& head, uint64_t scene_hash, const std::filesystem::path& file);

}  // namespace sightline
