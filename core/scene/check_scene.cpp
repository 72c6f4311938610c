#include "core/scene/check_scene.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/scene/instances.h"

namespace sightline {
namespace {

constexpr size_t kMostTriangles = 0xfffffffd;

bool isSound(const Scene& scene, const glm::uvec3& triangle) {
  for (int corner = 0; corner < 3; ++corner) {
    if (triangle[corner] >= scene.positions.size()) return false;
    const glm::vec3& position = scene.positions[triangle[corner]];
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(position[axis]) <= kLargestCoordinate)) return false;  // NaN too
    }
  }
  return true;
}

/// The first triangle that is not sound; their number if all are.
size_t firstBroken(const Scene& scene) {
  const size_t count = scene.triangles.size();
  return tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, count, 1 << 16), count,
      [&](const tbb::blocked_range<size_t>& range, size_t first) {
        for (size_t i = range.begin(); i < std::min(range.end(), first); ++i) {
          if (!isSound(scene, scene.triangles[i])) return i;
        }
        return first;
      },
      [](size_t a, size_t b) { return std::min(a, b); });
}

/// That meshes lie behind what is in none, and behind each other, and use what is theirs.
void checkMeshes(const Scene& scene) {
  uint64_t position = scene.plainPositions(), triangle = scene.plainTriangles();
  const auto check = [&](uint64_t first, uint64_t end, uint64_t low, uint64_t high) {
    for (uint64_t i = first; i < end; ++i) {
      for (int corner = 0; corner < 3; ++corner) {
        if (scene.triangles[i][corner] >= low && scene.triangles[i][corner] < high) continue;
        throw Error(fmt::format("stored triangle {}: vertex {} is not from {} to {}", i,
                                scene.triangles[i][corner], low, high - 1));
      }
    }
  };
  check(0, triangle, 0, position);
  for (const SceneMesh& mesh : scene.meshes) {
    if (mesh.first_position != position || mesh.first_triangle != triangle || mesh.position_count == 0 ||
        mesh.triangle_count == 0) {
      throw Error("a mesh is empty, or does not follow the one before it");
    }
    position += mesh.position_count;
    triangle += mesh.triangle_count;
    if (position > scene.positions.size() || triangle > scene.triangles.size()) {
      throw Error("a mesh ends behind what is stored");
    }
    check(mesh.first_triangle, triangle, mesh.first_position, position);
  }
  if (position != scene.positions.size() || triangle != scene.triangles.size()) {
    throw Error("there are triangles or positions behind those of the last mesh");
  }
}

/// Returns how many triangles there are in all.
size_t checkInstances(const Scene& scene) {
  checkMeshes(scene);
  std::vector<Bounds> bounds;
  for (const SceneMesh& mesh : scene.meshes) {
    Bounds box{scene.positions[mesh.first_position], scene.positions[mesh.first_position]};
    for (uint32_t i = 0; i < mesh.position_count; ++i) {
      box.low = glm::min(box.low, scene.positions[mesh.first_position + i]);
      box.high = glm::max(box.high, scene.positions[mesh.first_position + i]);
    }
    bounds.push_back(box);
  }
  uint64_t in_meshes = 0, vertices = scene.plainPositions();
  for (const SceneInstance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size() || instance.first_id < in_meshes ||
        instance.first_id - in_meshes != instance.plain_before ||
        instance.plain_before > scene.plainTriangles() || instance.first_vertex != vertices) {
      throw Error("an instance is of no mesh, out of order, or was not counted (countInstances)");
    }
    if (!canPlace(instance.place, bounds[instance.mesh])) {
      throw Error(fmt::format("the instance at triangle {} has a placement that cannot be traced (canPlace)",
                              instance.first_id));
    }
    in_meshes += scene.meshes[instance.mesh].triangle_count;
    vertices += scene.meshes[instance.mesh].position_count;
  }
  if (vertices > kMostTriangles)
    throw Error(fmt::format("the scene has {} vertices, too many for numbers", vertices));
  return in_meshes + scene.plainTriangles();
}

}  // namespace

void checkScene(const Scene& scene) {
  if (scene.triangles.empty()) throw Error("the scene has no triangles");
  const size_t stored = scene.triangles.size();
  if (!scene.surfaces.empty() && scene.surfaces.words.size() != stored) {
    throw Error(
        fmt::format("{} triangles are stored, but {} have a surface", stored, scene.surfaces.words.size()));
  }
  const size_t count = scene.hasInstances() ? checkInstances(scene) : stored;
  if (count == 0) throw Error("the scene has no triangles");
  if (count > kMostTriangles) throw Error(fmt::format("the scene has {} triangles, too many for ids", count));
  if (const size_t broken = firstBroken(scene); broken < stored) {
    const glm::uvec3& t = scene.triangles[broken];
    throw Error(
        fmt::format("triangle {} (vertices {}, {}, {}): a vertex is not among the {} there are, is not "
                    "finite or is beyond {:g}",
                    broken, t.x, t.y, t.z, scene.positions.size(), kLargestCoordinate));
  }
  uint64_t covered = 0;
  for (const SceneObject& object : scene.objects) {
    if (object.first_triangle != covered || object.triangle_count == 0) {
      throw Error(fmt::format("object \"{}\" begins at triangle {}, where {} is next, or has none",
                              object.name, object.first_triangle, covered));
    }
    covered += object.triangle_count;
  }
  if (!scene.objects.empty() && covered != count) {
    throw Error(fmt::format("the objects have {} triangles, the scene {}", covered, count));
  }
}

}  // namespace sightline
