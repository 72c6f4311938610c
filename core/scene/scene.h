#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/extents.h"
#include "core/scene/surfaces.h"

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
};

/// A static scene: nothing but triangles. A triangle's id is its index in `triangles`, which follows file
/// order over all meshes and instances. Invariants (kept by loadScene and the generators): at least one
/// triangle, fewer than 2^32 - 2; every index is in range; every coordinate is at most
/// kLargestCoordinate in magnitude; the objects' ranges
/// are ascending, disjoint and cover all triangles.
struct Scene {
  std::vector<glm::vec3> positions;   ///< world space, y up by custom; units are the file's
  std::vector<glm::uvec3> triangles;  ///< indices into positions
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

  uint32_t triangleCount() const { return static_cast<uint32_t>(triangles.size()); }
  uint64_t vertexCount() const { return positions.size(); }

  /// Where triangle `id` is, in world space. Whoever only asks where triangles are asks here, not in
  /// `triangles`.
  std::array<glm::vec3, 3> corners(uint32_t id) const {
    const glm::uvec3& t = triangles[id];
    return {positions[t.x], positions[t.y], positions[t.z]};
  }

  /// Its vertices' numbers, 0 .. vertexCount() - 1: triangles that share one have the same number for it.
  glm::uvec3 vertexNumbers(uint32_t id) const { return triangles[id]; }
};

/// Hash of positions and triangles, and of surfaces and offset where there are any (XXH3, 64 bit): what a PVS
/// depends on.
uint64_t hashScene(const Scene& scene);

/// Axis-aligned bounds of the vertices that triangles use.
struct Bounds {
  glm::vec3 low{0};
  glm::vec3 high{0};
};
Bounds sceneBounds(const Scene& scene);

}  // namespace sightline
