#include "core/scene/check_scene.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

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

}  // namespace

void checkScene(const Scene& scene) {
  const size_t count = scene.triangles.size();
  if (count == 0) throw Error("the scene has no triangles");
  if (count > kMostTriangles) throw Error(fmt::format("the scene has {} triangles, too many for ids", count));
  if (const size_t broken = firstBroken(scene); broken < count) {
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
