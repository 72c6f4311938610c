#include "core/scene/instances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/error.h"
#include "core/scene/instance_record.h"
#include "core/scene/largest.h"

namespace sightline {
namespace {

constexpr double kMostStretch = 0x1p20;
constexpr double kMostCondition = 1024;
/// How many times larger than the result the sums of placeVertex may be.
constexpr double kMostCancellation = 4;
constexpr uint64_t kLeastSaved = 1u << 20;
constexpr uint64_t kLeastUse = 4;

/// Infinite where an entry is not finite.
double largestRowSum(const glm::dmat3& m) {
  double most = 0;
  for (int row = 0; row < 3; ++row) {
    const double sum = std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]);
    most = std::isfinite(sum) ? std::max(most, sum) : HUGE_VAL;
  }
  return most;
}

}  // namespace

bool canPlace(const Placement& place, const Bounds& bounds) {
  const glm::dmat3 linear = linearPart(place);
  const glm::dmat3 inverse = glm::inverse(linear);
  const double stretch = largestRowSum(linear), shrink = largestRowSum(inverse);
  // Negations, so that NaN is refused.
  if (!(stretch <= kMostStretch && shrink <= kMostStretch && stretch * shrink <= kMostCondition))
    return false;
  const glm::dvec3 low(bounds.low), high(bounds.high);
  if (!(largest(glm::abs(low)) <= kLargestCoordinate && largest(glm::abs(high)) <= kLargestCoordinate))
    return false;
  const glm::dvec3 origin(place.origin);
  const double sums = largestSum(place, bounds);
  double out = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 v(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    out = std::max(out, largest(glm::abs(linear * v + origin)));
  }
  return std::isfinite(sums) && sums <= kLargestCoordinate / 2 && sums <= kMostCancellation * out;
}

bool instancesPay(uint64_t stored_triangles, uint64_t all_triangles) {
  return all_triangles >= kLeastUse * stored_triangles && all_triangles - stored_triangles >= kLeastSaved;
}

void countInstances(Scene& scene) {
  uint32_t in_meshes = 0;
  uint64_t vertices = scene.plainPositions();
  for (SceneInstance& instance : scene.instances) {
    instance.plain_before = instance.first_id - in_meshes;
    instance.first_vertex = vertices;
    instance.mirrors = glm::determinant(linearPart(instance.place)) < 0;
    in_meshes += scene.meshes[instance.mesh].triangle_count;
    vertices += scene.meshes[instance.mesh].position_count;
  }
}

Surfaces flatSurfaces(const Scene& scene) {
  Surfaces flat;
  if (scene.surfaces.empty()) return flat;
  if (const uint64_t masked = countSurfaces(scene).masked; masked > uint64_t(kSurfaceIndex) + 1) {
    throw Error(fmt::format("{} triangles with masks, {} at most where instances are written out", masked,
                            uint64_t(kSurfaceIndex) + 1));
  }
  flat.masks = scene.surfaces.masks;
  flat.texels = scene.surfaces.texels;
  flat.words.reserve(scene.triangleCount());
  uint32_t masked = 0;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    const uint32_t word = scene.surfaceOf(id);
    if ((word & kSurfaceMasked) != 0) flat.masked.push_back(scene.maskPlaces(id));
    flat.words.push_back(flatWord(word, masked));
  }
  return flat;
}

Scene flatten(Scene scene) {
  if (!scene.hasInstances()) return scene;
  std::vector<glm::vec3> positions;
  positions.reserve(scene.vertexCount());
  positions.assign(scene.positions.begin(), scene.positions.begin() + scene.plainPositions());
  for (const SceneInstance& instance : scene.instances) {
    const SceneMesh& mesh = scene.meshes[instance.mesh];
    for (uint32_t i = 0; i < mesh.position_count; ++i) {
      positions.push_back(placeVertex(instance.place, scene.positions[mesh.first_position + i]));
    }
  }
  std::vector<glm::uvec3> triangles(scene.triangleCount());
  for (uint32_t id = 0; id < triangles.size(); ++id) triangles[id] = scene.vertexNumbers(id);
  scene.surfaces = flatSurfaces(scene);
  scene.positions = std::move(positions);
  scene.triangles = std::move(triangles);
  scene.meshes.clear();
  scene.instances.clear();
  return scene;
}

}  // namespace sightline
