#pragma once
#include <random>

#include "core/scene/instances.h"
#include "core/scene/masked_triangle.h"

namespace sightline::testing_support {

/// Adds meshes, plain triangles and instances to a scene, in the order of ids.
class InstancedScene {
 public:
  /// All plain triangles are in `plain`, ids run on as they are placed.
  explicit InstancedScene(Scene plain) : scene_(std::move(plain)) {
    plain_ = scene_.triangleCount();
    scene_.objects.clear();
  }

  uint32_t addMesh(const Scene& mesh) {
    const auto first = static_cast<uint32_t>(scene_.positions.size());
    scene_.meshes.push_back({first, static_cast<uint32_t>(mesh.positions.size()),
                             static_cast<uint32_t>(scene_.triangles.size()), mesh.triangleCount()});
    scene_.positions.insert(scene_.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const glm::uvec3& t : mesh.triangles) scene_.triangles.push_back(t + first);
    return static_cast<uint32_t>(scene_.meshes.size() - 1);
  }

  /// The next plain triangles get the next ids.
  void usePlain(uint32_t count) {
    scene_.objects.push_back({"plain", next_, count});
    next_ += count;
    plain_used_ += count;
  }
  uint32_t plainLeft() const { return plain_ - plain_used_; }

  void place(uint32_t mesh, const Placement& place) {
    SceneInstance instance;
    instance.mesh = mesh;
    instance.first_id = next_;
    instance.place = place;
    scene_.instances.push_back(instance);
    scene_.objects.push_back({"instance", next_, scene_.meshes[mesh].triangle_count});
    next_ += scene_.meshes[mesh].triangle_count;
  }

  Scene finish() {
    if (plainLeft() > 0) usePlain(plainLeft());
    countInstances(scene_);
    return std::move(scene_);
  }

 private:
  Scene scene_;
  uint32_t plain_ = 0, plain_used_ = 0, next_ = 0;
};

/// Random numbers that are the same everywhere.
class TestRandom {
 public:
  explicit TestRandom(uint64_t seed) : engine_(seed) {}
  float between(float low, float high) { return low + (high - low) * float(engine_() >> 40) * 0x1p-24f; }
  uint32_t below(uint32_t n) { return uint32_t(engine_() % n); }
  glm::vec3 inCube(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937_64 engine_;
};

/// Triangles with shared vertices, in a cube about `middle`.
inline Scene randomMesh(TestRandom& random, uint32_t triangles, float half, glm::vec3 middle = glm::vec3(0)) {
  Scene mesh;
  for (uint32_t i = 0; i < triangles; ++i) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    const glm::vec3 at = middle + random.inCube(half);
    for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(at + random.inCube(half * 0.3f));
    const bool shares = first > 0 && random.below(2) == 0;
    mesh.triangles.emplace_back(shares ? first - 1 : first, first + 1, first + 2);
  }
  return mesh;
}

/// Turned, scaled along three axes, sheared, and every other time mirrored.
inline Placement randomPlacement(TestRandom& random, float reach) {
  for (;;) {
    glm::mat3 m;
    for (int column = 0; column < 3; ++column) m[column] = random.inCube(2.0f);
    const glm::vec3 at = random.inCube(reach);
    const Placement place{vec4(m[0], 0), vec4(m[1], 0), vec4(m[2], 0), vec4(at, 0)};
    if (canPlace(place, {glm::vec3(-1), glm::vec3(1)})) return place;
  }
}

/// A scene of `instances` placements of a few meshes, with plain triangles between them.
inline Scene randomInstances(uint64_t seed, uint32_t instances, uint32_t mesh_triangles, float reach = 20) {
  TestRandom random(seed);
  InstancedScene scene(randomMesh(random, 40, reach));
  for (int i = 0; i < 3; ++i) scene.addMesh(randomMesh(random, 1 + random.below(mesh_triangles), 0.5f));
  for (uint32_t i = 0; i < instances; ++i) {
    if (random.below(4) == 0 && scene.plainLeft() > 3) scene.usePlain(1 + random.below(3));
    scene.place(random.below(3), randomPlacement(random, reach));
  }
  return scene.finish();
}

/// The same with surfaces: each stored triangle opaque, or with holes, of glass, without a back, or of
/// several kinds.
inline Scene withSurfaces(Scene scene, uint64_t seed) {
  TestRandom random(seed);
  Surfaces& surfaces = scene.surfaces;
  const glm::uvec2 sizes[] = {{4, 4}, {7, 3}, {64, 33}};
  for (const glm::uvec2 size : sizes) {
    for (uint32_t wrap = 0; wrap < 3; ++wrap) {
      addMask(surfaces, size.x, size.y, {wrap, (wrap + size.x) % 3},
              [&](uint64_t) { return random.below(2) == 0; });
    }
  }
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    uint32_t word = random.below(4) == 0 ? kSurfaceFrontOnly : 0u;
    if (random.below(3) == 0) word |= kSurfaceGlass;
    if (random.below(2) == 0) {
      const auto mask = random.below(uint32_t(surfaces.masks.size()));
      glm::dvec2 places[3];
      for (glm::dvec2& place : places) {
        place.x = random.between(-20, 20);
        place.y = random.between(-20, 20);
      }
      word |= kSurfaceMasked | uint32_t(surfaces.masked.size());
      surfaces.masked.push_back(*maskedTriangle(surfaces, mask, places));
    }
    surfaces.words.push_back(word);
  }
  return scene;
}

}  // namespace sightline::testing_support
