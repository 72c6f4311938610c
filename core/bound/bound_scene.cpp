#include "core/bound/bound_scene.h"

#include "core/scene/instances.h"

namespace sightline {
namespace {

/// Appends the stored triangles from first on that no ray passes, with their vertices less `shift`.
void appendOpaque(const Scene& scene, uint32_t first, uint32_t count, uint32_t shift, Scene& part) {
  for (uint32_t i = first; i < first + count; ++i) {
    if ((scene.surfaces.of(i) & kPassable) == 0) part.triangles.push_back(scene.triangles[i] - shift);
  }
}

/// The triangles that no ray passes, as a scene of their own, instances behind what is in no mesh.
Scene opaquePart(const Scene& scene) {
  Scene part;
  part.positions.assign(scene.positions.begin(), scene.positions.begin() + scene.plainPositions());
  appendOpaque(scene, 0, scene.plainTriangles(), 0, part);
  auto next_id = uint32_t(part.triangles.size());
  std::vector<uint32_t> numbers(scene.meshes.size(), kNoTriangle);
  for (size_t i = 0; i < numbers.size(); ++i) {
    const SceneMesh& mesh = scene.meshes[i];
    const SceneMesh kept{uint32_t(part.positions.size()), mesh.position_count,
                         uint32_t(part.triangles.size()), 0};
    appendOpaque(scene, mesh.first_triangle, mesh.triangle_count, mesh.first_position - kept.first_position,
                 part);
    const auto count = uint32_t(part.triangles.size()) - kept.first_triangle;
    if (count == 0) continue;
    const auto begin = scene.positions.begin() + mesh.first_position;
    part.positions.insert(part.positions.end(), begin, begin + mesh.position_count);
    numbers[i] = uint32_t(part.meshes.size());
    part.meshes.push_back(kept);
    part.meshes.back().triangle_count = count;
  }
  for (SceneInstance instance : scene.instances) {
    instance.mesh = numbers[instance.mesh];
    if (instance.mesh == kNoTriangle) continue;
    instance.first_id = next_id;
    next_id += part.meshes[instance.mesh].triangle_count;
    part.instances.push_back(instance);
  }
  countInstances(part);
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
