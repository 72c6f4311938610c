#include "core/scene/scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory>
#include <new>

#include "core/scene/instances.h"
#include "core/scene/masked_triangle.h"

#define SL_INSTANCES_PARAM const Scene& scene
#define SL_INSTANCE_IDS(k) instanceIds(scene, k)
namespace sightline {
namespace {

uvec4 instanceIds(const Scene& scene, uint32_t k) {
  const SceneInstance& instance = scene.instances[k];
  const SceneMesh& mesh = scene.meshes[instance.mesh];
  return {instance.first_id, mesh.triangle_count, instance.plain_before, mesh.first_triangle};
}

}  // namespace
}  // namespace sightline
#include "core/shared/find_triangle.inl"

namespace sightline {
namespace {

/// Triangles or positions that are hashed at a time where they must be made first.
constexpr size_t kHashPiece = 1 << 14;

/// XXH3 of a sequence of arrays.
class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), XXH3_freeState) {
    if (state_ == nullptr) throw std::bad_alloc();
    XXH3_64bits_reset(state_.get());
  }

  template <typename T>
  void add(const T* values, size_t count) {
    XXH3_64bits_update(state_.get(), values, count * sizeof(T));
  }

  /// What make(i) returns for i = 0 .. count - 1.
  template <typename Make>
  void addMade(uint64_t count, Make&& make) {
    std::vector<decltype(make(uint64_t(0)))> piece;
    for (uint64_t first = 0; first < count; first += kHashPiece) {
      piece.clear();
      for (uint64_t i = first; i < std::min(count, first + kHashPiece); ++i) piece.push_back(make(i));
      add(piece.data(), piece.size());
    }
  }

  uint64_t digest() const { return XXH3_64bits_digest(state_.get()); }

 private:
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

void hashSurfaces(const Scene& scene, Hasher& hasher) {
  const auto add = [&](const auto& list) {
    const uint64_t size = list.size();
    hasher.add(&size, 1);
    hasher.add(list.data(), list.size());
  };
  const Surfaces& surfaces = scene.surfaces;
  if (scene.hasInstances()) {
    const uint64_t count = scene.triangleCount();
    uint32_t next = 0;
    hasher.add(&count, 1);
    hasher.addMade(count, [&](uint64_t i) { return flatWord(scene.surfaceOf(uint32_t(i)), next); });
    const uint64_t masked = countSurfaces(scene).masked;
    hasher.add(&masked, 1);
    uint32_t id = 0;
    hasher.addMade(masked, [&](uint64_t) {
      while ((scene.surfaceOf(id) & kSurfaceMasked) == 0) ++id;
      return scene.maskPlaces(id++);
    });
  } else {
    add(surfaces.words);
    add(surfaces.masked);
  }
  add(surfaces.masks);
  add(surfaces.texels);
}

}  // namespace

StoredTriangle Scene::stored(uint32_t id) const {
  return findTriangle(*this, static_cast<uint32_t>(instances.size()), id);
}

uint32_t Scene::runEnd(uint32_t id, StoredTriangle at) const {
  if (at.instance != kNoTriangle) {
    return instances[at.instance].first_id + meshes[instances[at.instance].mesh].triangle_count;
  }
  const auto next =
      std::upper_bound(instances.begin(), instances.end(), id,
                       [](uint32_t value, const SceneInstance& i) { return value < i.first_id; });
  return next == instances.end() ? triangleCount() : next->first_id;
}

MaskedTriangle Scene::maskPlaces(uint32_t id) const {
  const StoredTriangle at = stored(id);
  const MaskedTriangle& its = surfaces.masked[surfaces.of(at.triangle) & kSurfaceIndex];
  return at.instance != kNoTriangle && instances[at.instance].mirrors ? mirrored(its) : its;
}

SurfaceCounts countSurfaces(const Scene& scene) {
  SurfaceCounts counts;
  if (scene.surfaces.empty()) return counts;
  const auto add = [&](uint32_t first, uint32_t count, uint64_t times) {
    for (uint32_t i = first; i < first + count; ++i) countSurface(counts, scene.surfaces.words[i], times);
  };
  add(0, scene.plainTriangles(), 1);
  std::vector<uint64_t> uses(scene.meshes.size(), 0);
  for (const SceneInstance& instance : scene.instances) ++uses[instance.mesh];
  for (size_t i = 0; i < uses.size(); ++i) {
    add(scene.meshes[i].first_triangle, scene.meshes[i].triangle_count, uses[i]);
  }
  return counts;
}

glm::uvec3 Scene::vertexNumbers(uint32_t id) const {
  if (!hasInstances()) return triangles[id];
  const StoredTriangle at = stored(id);
  glm::uvec3 numbers = triangles[at.triangle];
  if (at.instance == kNoTriangle) return numbers;
  const SceneInstance& instance = instances[at.instance];
  if (instance.mirrors) std::swap(numbers.y, numbers.z);
  return numbers - meshes[instance.mesh].first_position + static_cast<uint32_t>(instance.first_vertex);
}

uint64_t hashScene(const Scene& scene) {
  static_assert(std::endian::native == std::endian::little, "the hash is of little-endian bytes");
  static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::uvec3) == 12);
  const std::array<uint64_t, 2> counts = {scene.vertexCount(), scene.triangleCount()};
  Hasher hasher;
  hasher.add(counts.data(), counts.size());
  hasher.add(scene.positions.data(), scene.plainPositions());
  for (const SceneInstance& instance : scene.instances) {
    const SceneMesh& mesh = scene.meshes[instance.mesh];
    hasher.addMade(mesh.position_count, [&](uint64_t i) {
      return placeVertex(instance.place, scene.positions[mesh.first_position + i]);
    });
  }
  if (!scene.hasInstances()) {
    hasher.add(scene.triangles.data(), scene.triangles.size());
  } else {
    hasher.addMade(scene.triangleCount(), [&](uint64_t i) { return scene.vertexNumbers(uint32_t(i)); });
  }
  if (scene.offset != glm::dvec3(0.0)) {
    hasher.add(&scene.offset, 1);
  }
  if (!scene.surfaces.empty()) hashSurfaces(scene, hasher);
  return hasher.digest();
}

Bounds sceneBounds(const Scene& scene) {
  if (scene.triangleCount() == 0) return {};
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Bounds nothing{glm::vec3(kInfinity), glm::vec3(-kInfinity)};
  return tbb::parallel_reduce(
      tbb::blocked_range<uint32_t>(0, scene.triangleCount(), 1 << 16), nothing,
      [&](const tbb::blocked_range<uint32_t>& range, Bounds bounds) {
        scene.visitTriangles(range.begin(), range.end(), [&](uint32_t, const auto& corners) {
          for (const glm::vec3& position : corners) {
            bounds.low = glm::min(bounds.low, position);
            bounds.high = glm::max(bounds.high, position);
          }
        });
        return bounds;
      },
      [](const Bounds& a, const Bounds& b) {
        return Bounds{glm::min(a.low, b.low), glm::max(a.high, b.high)};
      });
}

}  // namespace sightline
