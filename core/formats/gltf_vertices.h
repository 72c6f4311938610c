#pragma once
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/formats/gltf_data.h"
#include "core/formats/gltf_document.h"
#include "core/formats/gltf_tree.h"
#include "core/formats/scene_builder.h"

namespace sightline {

/// What a primitive's vertices come from, in the place of an instance. Equal sources give the same vertices,
/// which the primitives then share.
struct GltfVertexSource {
  size_t positions = 0;                              ///< accessor
  std::vector<std::pair<size_t, uint64_t>> targets;  ///< accessors and weights (a double's bits) of morph
                                                     ///< targets whose weight is not 0
  std::optional<size_t> skin;                        ///< then joints and weights are not empty
  std::vector<size_t> joints, weights;               ///< accessors
  std::array<uint64_t, 16> to_world = {};            ///< a matrix's bits; identity with a skin
  auto operator<=>(const GltfVertexSource&) const = default;
};

/// Vertices of the scene made from one source.
struct GltfVertexRun {
  VertexRange range;
  bool mirrored = false;               ///< their place turns the front of triangles to the back
  std::vector<bool> mirrored_by_skin;  ///< the same for each vertex of a skinned mesh
  bool isMirrored(int64_t corner) const {
    return corner >= 0 && size_t(corner) < mirrored_by_skin.size() ? mirrored_by_skin[size_t(corner)]
                                                                   : mirrored;
  }
};

/// Makes the vertices of a glTF document: morph targets by their default weights, then the skin, whose joints
/// alone say where a skinned mesh stands, or else the node's place.
class GltfVertices {
 public:
  GltfVertices(const GltfDocument& document, const GltfTree& tree, GltfData& data, const std::string& file,
               SceneBuilder& builder);

  /// GltfVertexSource::to_world of vertices that stay where they are.
  static std::array<uint64_t, 16> inPlace();

  /// For a primitive with positions.
  GltfVertexSource source(const GltfInstance& instance, const GltfPrimitive& primitive) const;

  /// Throws Error unless all data of the source is there and fits together: to be seen before room is made
  /// for it. (Sparse positions over zeros that no view holds are refused too: they make no mesh, and would
  /// let a small file claim any count.)
  void check(const GltfVertexSource& source);

  /// Adds the vertices to the builder, once for equal sources.
  const GltfVertexRun& add(const GltfVertexSource& source);

  /// Vertices whose weights are all 0: they follow their first joint.
  uint64_t unweighted() const { return unweighted_; }

 private:
  struct Influences;

  void checkSkin(const GltfVertexSource& source);
  void checkElements(size_t accessor, uint32_t width, const char* what, const char* type);
  void checkCount(size_t accessor, size_t positions) const;
  const std::vector<glm::dmat4>& jointMatrices(size_t skin);
  glm::dmat4 blend(Influences& influences, const GltfVertexSource& source, uint64_t vertex);
  std::string accessorPlace(size_t accessor) const;

  const GltfDocument& document_;
  const GltfTree& tree_;
  GltfData& data_;
  const std::string& file_;
  SceneBuilder& builder_;
  std::map<GltfVertexSource, GltfVertexRun> runs_;
  std::map<size_t, std::vector<glm::dmat4>> joint_matrices_;  ///< by skin
  uint64_t unweighted_ = 0;
};

}  // namespace sightline
