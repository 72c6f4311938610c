#pragma once
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/load_scene.h"
#include "core/formats/triangulate.h"
#include "core/scene/scene.h"

namespace sightline {

/// Most vertices and triangles that a scene may have: ids are 32 bit, the last two values are reserved.
inline constexpr uint64_t kMaxElements = 0xfffffffeull - 1;

/// A name fit for every file format: control characters and bytes that are not UTF-8 become '_', blanks at
/// both ends go.
std::string cleanName(std::string_view name);

/// The vertices that a polygon may use: corner i means vertex first + i of the scene, for 0 <= i < count.
/// Messages print i + number_of_first, as the file counts.
struct VertexRange {
  int64_t first = 0;
  int64_t count = 0;
  int64_t number_of_first = 0;
};

/// Thrown to start again: floats do not hold the scene unless this is taken off its coordinates.
struct NeedsOffset : std::exception {
  explicit NeedsOffset(const glm::dvec3& needed) : offset(needed) {}
  glm::dvec3 offset;
};

/// Collects what a loader reads into a Scene that keeps the invariants. Loaders say where they are by a
/// function that makes the text of the place ("city.obj:812"), called only for an error.
class SceneBuilder {
 public:
  using Place = std::function<std::string()>;

  /// offset: of the scene that is made.
  SceneBuilder(const SceneLoadOptions& options, const glm::dvec3& offset)
      : repair_(options.repair),
        flatten_(options.flatten),
        faces_(options.faces),
        may_need_offset_(!options.offset) {
    scene_.offset = offset;
  }

  /// Adds a vertex; `full` is the position as precise as the file has it, `position` that rounded to floats
  /// once. One that is not finite or too far out spoils the triangles that use it.
  void addPosition(const glm::vec3& position, const glm::dvec3& full, const Place& place);
  /// The same of a position that the offset has been taken off already.
  void addPlaced(const glm::dvec3& position, const Place& place);
  uint64_t positionCount() const { return scene_.positions.size(); }

  /// Following triangles belong to an object of that name. An empty or blank name becomes `fallback`.
  void beginObject(std::string_view name, const std::string& fallback,
                   const std::optional<GltfPart>& part = {});

  /// Following triangles are cut from the file's next face (Scene::faces): OBJ and PLY call it before each.
  void nextFace() { ++face_; }

  /// The surface word (core/shared/surface.h) of following triangles, 0 at first.
  void beginSurface(uint32_t word) { surface_ = word; }
  /// Gives the last triangle a surface of its own.
  void surfaceOfLast(uint32_t word);
  /// Adds flags to the surfaces of triangles that are there already.
  void addToSurfaces(uint64_t first, uint64_t count, uint32_t flags);
  /// To add masks and the records of masked triangles.
  Surfaces& surfaces() { return scene_.surfaces; }

  /// Adds the triangles of a polygon; its vertex numbers count within `vertices`. Bad numbers and fewer than
  /// three corners are errors, or, to repair, dropped and counted.
  void addPolygon(std::span<const int64_t> corners, const VertexRange& vertices, const Place& place);

  /// Counts triangles that repair drops before they come here.
  void countRepaired(uint64_t triangles) { scene_.repaired_triangles += triangles; }
  bool repairs() const { return repair_; }
  void countAlpha(uint64_t triangles) { scene_.alpha_triangles += triangles; }
  void countOpaqueMasks(uint64_t triangles) { scene_.opaque_mask_triangles += triangles; }
  void countGlass(uint64_t triangles) { scene_.glass_triangles += triangles; }
  /// Of the object that has begun.
  void countSingleSided(uint64_t triangles) {
    scene_.single_sided_triangles += triangles;
    object_.single_sided = true;
  }
  void countHiddenNodes(uint64_t nodes) { scene_.hidden_nodes += nodes; }
  /// What it names of the file is cleaned (cleanName): reports take UTF-8 only.
  void warn(std::string_view line) { scene_.warnings.push_back(cleanName(line)); }
  uint64_t triangleCount() const { return scene_.triangles.size() + placed_; }

  /// Adds a mesh for instances, positions, triangles and surface words of a scene; indices count within its
  /// positions, masked triangles among surfaces(). Returns its number.
  uint32_t addMesh(Scene mesh);

  /// Places a mesh (canPlace): its triangles come next, and are told to the objects that begin by
  /// countPlaced.
  void place(uint32_t mesh, const Placement& place);
  void countPlaced(uint64_t triangles) { placed_ += triangles; }

  /// What there is, for a mesh: no checks, no objects.
  Scene takeMesh() { return std::move(scene_); }

  /// Room for so many more, to avoid copies.
  void reserve(uint64_t positions, uint64_t triangles);

  /// The scene, with the degenerate triangles counted and a warning if single precision spoils it. Throws
  /// Error without any triangle, and NeedsOffset if the scene has no offset yet.
  Scene finish(const std::string& file);

 private:
  struct MeshData {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    std::vector<uint32_t> words;  ///< empty: all are opaque from both sides
  };

  void joinMeshes();
  void addTriangle(const glm::uvec3& triangle, const Place& place);
  bool usable(std::span<const int64_t> corners, const VertexRange& vertices, const Place& place) const;
  void add(const glm::vec3& position, const glm::dvec3& full, const Place& place);
  /// Which of the bad vertices it is, if it is one.
  std::optional<size_t> badVertex(int64_t index) const;
  [[noreturn]] void failAtBadVertex(size_t bad, const Place& face) const;
  void closeObject();

  bool repair_, flatten_;
  bool faces_;
  bool may_need_offset_;
  uint32_t face_ = ~0u;  ///< wraps to 0 with the first; only faces without triangles can be more than 2^32
  Scene scene_;
  SceneObject object_;
  uint32_t surface_ = 0;
  std::vector<std::pair<uint32_t, glm::vec3>> bad_vertices_;  ///< not finite or too far out; ascending
  std::vector<std::string> bad_places_;                       ///< where the first of them stand in the file
  bool file_has_floats_ = true;                               ///< looked at only with an offset
  std::vector<glm::vec3>
      remainders_;                  ///< what positions lost by rounding; shorter if the others lost nothing
  std::vector<glm::vec3> corners_;  ///< of the polygon in work
  std::vector<glm::uvec3> cut_;
  uint64_t cut_tests_left_ = kMaxCutTests;
  std::vector<MeshData> meshes_;
  uint64_t placed_ = 0;  ///< triangles of instances
};

}  // namespace sightline
