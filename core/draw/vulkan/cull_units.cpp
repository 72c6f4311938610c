#include "core/draw/vulkan/cull_units.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <unordered_map>

namespace sightline {
namespace {

CullUnit unitOf(const AxisBox& box, uint32_t first_slot, uint32_t triangles, uint32_t drawable) {
  return {glm::vec4(box.low, 0), glm::vec4(box.high, 0), {first_slot, triangles, drawable, 0}};
}

/// A drawable's own vertices and triangles, as meshoptimizer takes them.
struct LocalMesh {
  std::vector<uint32_t> vertices;  ///< numbers in the scene
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> indices;
};

LocalMesh localMesh(const Scene& scene, std::span<const uint32_t> triangles) {
  LocalMesh mesh;
  std::unordered_map<uint32_t, uint32_t> local;
  for (const uint32_t triangle : triangles) {
    const glm::uvec3 numbers = scene.vertexNumbers(triangle);
    const auto corners = scene.corners(triangle);
    for (int i = 0; i < 3; ++i) {
      const auto [at, fresh] = local.try_emplace(numbers[i], uint32_t(mesh.vertices.size()));
      if (fresh) {
        mesh.vertices.push_back(numbers[i]);
        mesh.positions.push_back(corners[size_t(i)]);
      }
      mesh.indices.push_back(at->second);
    }
  }
  return mesh;
}

/// Adds a drawable's meshlets; their slots and words are counted from the units' first.
void addMeshlets(const Scene& scene, const Drawables& drawables, uint32_t drawable, CullUnits& to) {
  const LocalMesh mesh = localMesh(scene, drawables.trianglesOf(drawable));
  const size_t bound = meshopt_buildMeshletsBound(mesh.indices.size(), kMeshletVertices, kMeshletTriangles);
  std::vector<meshopt_Meshlet> meshlets(bound);
  std::vector<unsigned int> vertices(bound * kMeshletVertices);
  std::vector<unsigned char> corners(bound * kMeshletTriangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), corners.data(), mesh.indices.data(),
                                        mesh.indices.size(), &mesh.positions.front().x, mesh.positions.size(),
                                        sizeof(glm::vec3), kMeshletVertices, kMeshletTriangles, 0));
  for (const meshopt_Meshlet& meshlet : meshlets) {
    const unsigned int* its_vertices = &vertices[meshlet.vertex_offset];
    const unsigned char* its_corners = &corners[meshlet.triangle_offset];
    AxisBox box{mesh.positions[its_vertices[0]], mesh.positions[its_vertices[0]]};
    for (uint32_t i = 0; i < meshlet.vertex_count; ++i) {
      box.low = glm::min(box.low, mesh.positions[its_vertices[i]]);
      box.high = glm::max(box.high, mesh.positions[its_vertices[i]]);
    }
    CullUnit unit = unitOf(box, uint32_t(to.indices.size() / 3), meshlet.triangle_count, drawable);
    unit.run.w = uint32_t(to.words.size());
    to.words.push_back(meshlet.vertex_count);
    for (uint32_t i = 0; i < meshlet.vertex_count; ++i) to.words.push_back(mesh.vertices[its_vertices[i]]);
    for (uint32_t i = 0; i < meshlet.triangle_count; ++i) {
      const unsigned char* c = &its_corners[size_t(3) * i];
      to.words.push_back(uint32_t(c[0]) | uint32_t(c[1]) << 8 | uint32_t(c[2]) << 16);
      for (int k = 0; k < 3; ++k) to.indices.push_back(mesh.vertices[its_vertices[c[k]]]);
    }
    to.units.push_back(unit);
  }
}

void append(const CullUnits& from, CullUnits& to) {
  const auto first_slot = uint32_t(to.indices.size() / 3), first_word = uint32_t(to.words.size());
  for (CullUnit unit : from.units) {
    unit.run.x += first_slot;
    unit.run.w += first_word;
    to.units.push_back(unit);
  }
  to.indices.insert(to.indices.end(), from.indices.begin(), from.indices.end());
  to.words.insert(to.words.end(), from.words.begin(), from.words.end());
}

template <typename AddOpaque>
CullUnits unitsOf(const Drawables& drawables, AddOpaque&& add_opaque) {
  CullUnits result;
  for (uint32_t kind = 0; kind < 3; ++kind) {
    for (uint32_t i = 0; i < drawables.list.size(); ++i) {
      const Drawable& drawable = drawables.list[i];
      if (drawable.alpha != AlphaKind(kind)) continue;
      if (drawable.alpha == AlphaKind::opaque) {
        add_opaque(i, result);
      } else {
        result.units.push_back(unitOf(drawable.box, drawable.first_triangle, drawable.triangle_count, i));
      }
    }
    result.ends[kind + 1] = uint32_t(result.units.size());
  }
  return result;
}

}  // namespace

CullUnits drawableUnits(const Drawables& drawables) {
  return unitsOf(drawables, [&](uint32_t i, CullUnits& to) {
    const Drawable& drawable = drawables.list[i];
    to.units.push_back(unitOf(drawable.box, drawable.first_triangle, drawable.triangle_count, i));
  });
}

uint64_t mostMeshletUnits(const Drawables& drawables) {
  uint64_t most = 0;
  for (const Drawable& drawable : drawables.list) {
    most += drawable.alpha == AlphaKind::opaque
                ? meshopt_buildMeshletsBound(size_t(3) * drawable.triangle_count, kMeshletVertices,
                                             kMeshletTriangles)
                : 1;
  }
  return most;
}

CullUnits meshletUnits(const Scene& scene, const Drawables& drawables) {
  std::vector<CullUnits> made(drawables.list.size());
  tbb::parallel_for(size_t(0), made.size(), [&](size_t i) {
    if (drawables.list[i].alpha == AlphaKind::opaque) addMeshlets(scene, drawables, uint32_t(i), made[i]);
  });
  return unitsOf(drawables, [&](uint32_t i, CullUnits& to) {
    append(made[i], to);
    made[i] = {};
  });
}

}  // namespace sightline
