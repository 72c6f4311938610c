#pragma once
#include <optional>

#include "core/scene/scene.h"
#include "core/voxel/voxelize.h"

namespace sightline {

/// Rays pass triangles with one of these: holes, glass, and what only has a front.
inline constexpr uint32_t kPassable = kSurfaceMasked | kSurfaceGlass | kSurfaceFrontOnly;

/// A scene's voxels, as bounds need them.
struct BoundScene {
  const Scene& scene;
  VoxelGrid all;  ///< met by a triangle
  /// Met by a triangle that no ray passes: without holes, glass and what only has a front. None: the same as
  /// all.
  std::optional<VoxelGrid> opaque;

  const VoxelGrid& walls() const { return opaque ? *opaque : all; }
};

/// Takes `all` as made of the scene by voxelize, or makes it (options.with_triangles is of no effect). Scene
/// and grids must stay where they are. Throws as voxelize.
BoundScene makeBoundScene(const Scene& scene, const VoxelizeOptions& options);
BoundScene makeBoundScene(const Scene& scene, VoxelGrid&& all, const VoxelizeOptions& options);

}  // namespace sightline
