#include "core/bound/bound_scene.h"

#include "core/scene/instances.h"

namespace sightline {
namespace {

constexpr uint32_t kPassable = kSurfaceMasked | kSurfaceGlass | kSurfaceFrontOnly;

// The triangles that no ray passes, as a scene of their own.
Scene opaquePart(const Scene& scene) {
  Scene part;
  part.positions = scene.positions;
  for (uint32_t id = 0; id < scene.triangles.size(); ++id) {
    if ((scene.surfaces.of(id) & kPassable) == 0) part.triangles.push_back(scene.triangles[id]);
  }
  return part;
}

}  // namespace

BoundScene makeBoundScene(const Scene& scene, const VoxelizeOptions& options) {
  VoxelizeOptions without_ids = options;
  without_ids.with_triangles = false;
  return makeBoundScene(scene, voxelize(scene, without_ids), options);
}

BoundScene makeBoundScene(const Scene& scene, VoxelGrid&& all, const VoxelizeOptions& options) {
  BoundScene result{scene, std::move(all), std::nullopt};
  // A scene with instances has no surfaces.
  if (!featuresOf(scene.surfaces).any()) return result;
  VoxelizeOptions without_ids = options;
  without_ids.with_triangles = false;
  const Scene part = opaquePart(scene);
  result.opaque.emplace();
  result.opaque->lattice = options.lattice;
  if (!part.triangles.empty()) result.opaque = voxelize(part, without_ids);
  return result;
}

}  // namespace sightline
