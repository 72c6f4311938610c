#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/picture/picture.h"

namespace sightline {

struct VoxelPicture {
  std::filesystem::path voxels, output;
  uint32_t level = 0;
  std::string device;
  PictureOptions size;                    ///< width and height
  std::optional<double> cut_height = {};  ///< leave out voxels that reach above it, in the scene file's units
  /// Draw what is not reached from these places, too: in the file's coordinates.
  std::vector<glm::dvec3> reach = {};
};

/// Draws a level of a voxel file, in the level's colour, what is not reached in another, and says what.
/// Throws Error.
void drawVoxels(const VoxelPicture& options);

}  // namespace sightline
