#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace sightline {

struct VoxelExport {
  std::filesystem::path voxels, out;
  std::string format;  ///< glb, obj, ply or vdb
  uint32_t level = 0;
  bool merge = false;  ///< faces to rectangles
};

/// Writes a level of a voxel file for other programs, and says what. Throws Error.
void exportVoxels(const VoxelExport& options);

}  // namespace sightline
