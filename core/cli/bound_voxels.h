#pragma once
#include <filesystem>
#include <optional>

#include "core/bound/bound_scene.h"
#include "core/voxel/voxel_file.h"

namespace sightline {

/// Voxels of a file for bounds of the scene, as it is in its file (`scene_hash` its hash); `scene` may be
/// that with more glass. Throws Error that names what else they are of.
inline VoxelGrid loadBoundVoxels(const std::filesystem::path& file, uint64_t scene_hash) {
  VoxelFile voxels = loadVoxels(file);
  requireScene(voxels.head, scene_hash, file);
  if (voxels.head.separation != Separation::kConservative) {
    throw Error(file.string() +
                    ": has not all voxels that triangles meet, which a bound needs: make it with "
                    "voxels --separate conservative",
                kExitUsage);
  }
  if (voxels.head.is_solid) {
    throw Error(
        file.string() +
            ": holds what is inside of solids as if triangles met it, and a bound looks for what they seal "
            "off itself: make it with voxels without --solid",
        kExitUsage);
  }
  return std::move(voxels.levels.front());
}

}  // namespace sightline
