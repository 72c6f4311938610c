#pragma once
#include <fmt/core.h>

#include <filesystem>

#include "core/base/error.h"
#include "core/voxel/voxel_file.h"

namespace sightline {

/// A level of a voxel file, 0 the finest. Throws Error that names the coarsest if the file has none such.
inline const VoxelGrid& levelOf(const VoxelFile& voxels, uint32_t level, const std::filesystem::path& file) {
  if (level < voxels.levels.size()) return voxels.levels[level];
  throw Error(fmt::format("{}: there is no level {}: the coarsest is {}", file.string(), level,
                          voxels.levels.size() - 1),
              kExitUsage);
}

}  // namespace sightline
