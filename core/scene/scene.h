#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/extents.h"
#include "core/scene/surfaces.h"
#include "core/shared/placement.h"

namespace sightline {

/// What of a glTF file an object shows: places in the file's lists of nodes and meshes, and in the mesh's
/// list of primitives. Objects of several nodes may show the same primitive.
struct GltfPart {
  uint32_t node = 0;
  uint32_t mesh = 0;
  uint32_t primitive = 0;
  bool operator==(const GltfPart&) const = default;
};

/// A named run of triangles, at least one. Names are not empty, valid UTF-8 and without control characters;
/// two objects may have the same. They come from
/// - OBJ: the statements o and g: "object", "group", or "object/group" where both hold; before any:
/// "default";
/// - glTF: "node", or "node/mesh" if the mesh has another name, then "/0", "/1", ... for the primitives of a
///   mesh that has several; a node without name is "node_7" by its index;
/// - PLY: the file's name without extension.
struct SceneObject {
  std::string name;
  uint32_t first_triangle = 0;
  uint32_t triangle_count = 0;
  std::optional<GltfPart> part = {};  ///< glTF only; the object's triangles are then the primitive's, in
                                      ///< order (without those that --repair dropped)
  bool single_sided = false;          ///< glTF doubleSided = false; of no effect but to be written again
};

/// Triangles that a scene holds once and shows in many places, with vertices of their own: runs of
/// Scene::positions and Scene::triangles, neither empty.
struct SceneMesh {
  uint32_t first_position = 0, position_count = 0;
  uint32_t first_triangle = 0, triangle_count = 0;
};

/// A mesh in a place. Its triangles' ids follow each other from first_id on.
struct SceneInstance {
  uint32_t mesh = 0;  ///< in Scene::meshes
  uint32_t first_id = 0;
  Placement place{};
  // Of countInstances (core/scene/instances.h):
  uint32_t plain_before = 0;  ///< triangles in no mesh with lower ids
  uint64_t first_vertex = 0;  ///< number of its first vertex (Scene::vertexNumbers)
  bool mirrors = false;       ///< the placement turns fronts to backs: two corners change places
};

/// A static scene: nothing but triangles. A triangle's id follows file order over all meshes and instances.
///
/// A plain scene (no instances, as most are) holds each triangle where it is: ids are indices of `triangles`.
/// A scene with instances holds what is used more than once in `meshes`, in the mesh's own space, behind the
/// plain triangles. It stands for the plain scene that flatten() (core/scene/instances.h) makes of it: all
/// that is said of ids, corners, counts, bounds and the hash is the same for both, bit for bit. So are sets
/// on devices that trace by core/shared (DeviceInfo::exact).
///
/// Invariants (kept by loadScene and the generators): at least one triangle, fewer than 2^32 - 2; every index
/// is in range; every coordinate is at most kLargestCoordinate in magnitude; the objects' ranges are
/// ascending, disjoint and cover all triangles; meshes follow the plain triangles and positions, and each
/// other, without a gap; instances are ascending in first_id and do not overlap; each placement passes
/// canPlace; surfaces, where there are any, have a word for each stored triangle.
struct Scene {
  std::vector<glm::vec3>
      positions;  ///< world space (of meshes: their own), y up by custom; units are the file's
  std::vector<glm::uvec3> triangles;  ///< indices into positions; a mesh's are into its own run
  std::vector<SceneMesh> meshes;
  std::vector<SceneInstance> instances;
  std::vector<SceneObject> objects;
  std::vector<uint32_t>
      faces;          ///< of OBJ and PLY, if loading was asked for them, else empty: the face in its
                      ///< file that each triangle is cut from, counted from 0 through the whole
                      ///< file. OBJ: f and fo statements; PLY: rows of faces, triangles of tristrips
  Surfaces surfaces;  ///< holes, glass, and sides; empty where there are none
  /// Whole numbers that were taken off the file's coordinates, where floats would not have held those: a
  /// place in the file is positions[i] + offset. Cells files have the file's own coordinates: what reads one
  /// moves its cells by -offset (core/cell/view_cell.h), as bake (core/api/bake.h) does.
  glm::dvec3 offset{0.0};
  uint64_t degenerate_triangles = 0;    ///< zero area: kept (ids stay), cannot be hit
  uint64_t repaired_triangles = 0;      ///< dropped by --repair: bad index or vertex
  uint64_t alpha_triangles = 0;         ///< glTF alphaMode MASK or BLEND
  uint64_t glass_triangles = 0;         ///< others that one sees through (glTF transmission, OBJ d, Tr or
                                        ///< map_d)
  uint64_t single_sided_triangles = 0;  ///< glTF doubleSided = false
  uint64_t opaque_mask_triangles = 0;   ///< those of glTF masks that were loaded as opaque
  uint64_t hidden_nodes = 0;            ///< left out by glTF's KHR_node_visibility, with those below them
  std::vector<std::string> warnings;    ///< a line each: what else of the file is not in the scene, or only
                                        ///< roughly

  bool hasInstances() const { return !instances.empty(); }

  /// Triangles and positions that are in no mesh.
  uint32_t plainTriangles() const {
    return meshes.empty() ? static_cast<uint32_t>(triangles.size()) : meshes.front().first_triangle;
  }
  uint32_t plainPositions() const {
    return meshes.empty() ? static_cast<uint32_t>(positions.size()) : meshes.front().first_position;
  }

  /// Of all ids, whatever is stored once.
  uint32_t triangleCount() const {
    if (!hasInstances()) return static_cast<uint32_t>(triangles.size());
    const SceneInstance& last = instances.back();
    return last.first_id + meshes[last.mesh].triangle_count + plainTriangles() - last.plain_before;
  }
  uint64_t vertexCount() const {
    if (!hasInstances()) return positions.size();
    return instances.back().first_vertex + meshes[instances.back().mesh].position_count;
  }

  /// Where triangle `id` is, in world space. Whoever only asks where triangles are asks here, not in
  /// `triangles`.
  std::array<glm::vec3, 3> corners(uint32_t id) const {
    return hasInstances() ? cornersOf(stored(id)) : storedCorners(id);
  }

  /// Its vertices' numbers, 0 .. vertexCount() - 1: triangles that share one have the same number for it.
  glm::uvec3 vertexNumbers(uint32_t id) const;

  /// What a ray meets at the triangle (core/shared/surface.h).
  uint32_t surfaceOf(uint32_t id) const {
    return surfaces.empty() ? 0u : surfaces.of(hasInstances() ? stored(id).triangle : id);
  }
  /// Of a masked one: where its corners lie in the mask's image, in the order of corners().
  MaskedTriangle maskPlaces(uint32_t id) const;

  /// Where the triangle's corners are stored: what is kept for each stored triangle is found so.
  StoredTriangle stored(uint32_t id) const;

  /// The corners of a stored triangle where an instance, by its index, has them.
  std::array<glm::vec3, 3> cornersOf(StoredTriangle stored) const {
    const auto t = storedCorners(stored.triangle);
    if (stored.instance == kNoTriangle) return t;
    const SceneInstance& instance = instances[stored.instance];
    const Corners placed =
        placeCorners(instance.place, instance.mirrors ? kInstanceMirrors : 0, t[0], t[1], t[2]);
    return {placed.a, placed.b, placed.c};
  }

  /// Calls visit(id, corners) for the ids from begin to end - 1: faster than to ask for each.
  template <typename Visit>
  void visitTriangles(uint32_t begin, uint32_t end, Visit&& visit) const {
    if (!hasInstances()) {
      for (uint32_t id = begin; id < end; ++id) visit(id, storedCorners(id));
      return;
    }
    while (begin < end) {
      StoredTriangle at = stored(begin);
      for (const uint32_t stop = std::min(end, runEnd(begin, at)); begin < stop; ++begin, ++at.triangle) {
        visit(begin, cornersOf(at));
      }
    }
  }

 private:
  std::array<glm::vec3, 3> storedCorners(uint32_t triangle) const {
    const glm::uvec3& t = triangles[triangle];
    return {positions[t.x], positions[t.y], positions[t.z]};
  }
  /// The first id that is not stored next to the others from `id` on.
  uint32_t runEnd(uint32_t id, StoredTriangle at) const;
};

/// Hash of positions and triangles, and of surfaces and offset where there are any (XXH3, 64 bit): what a PVS
/// depends on. Of a scene with instances that of the plain scene it stands for.
uint64_t hashScene(const Scene& scene);

/// Of all ids.
SurfaceCounts countSurfaces(const Scene& scene);

/// Axis-aligned bounds of the vertices that triangles use.
struct Bounds {
  glm::vec3 low{0};
  glm::vec3 high{0};
};
Bounds sceneBounds(const Scene& scene);

}  // namespace sightline
