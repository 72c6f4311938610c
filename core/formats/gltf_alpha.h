#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/formats/alpha_image.h"
#include "core/formats/gltf_data.h"
#include "core/formats/gltf_document.h"
#include "core/formats/load_scene.h"
#include "core/scene/masked_triangle.h"

namespace sightline {

/// What rays meet at the triangles of a primitive.
struct GltfSurface {
  uint32_t flags = 0;              ///< kSurfaceGlass, kSurfaceFrontOnly
  std::optional<uint32_t> mask;    ///< index in the scene's masks
  std::vector<glm::dvec2> places;  ///< of each vertex in the mask's image, in texels
  std::string place;               ///< of the places, for messages
};

/// Makes the surfaces of a glTF document's primitives: of masks, reads the textures, once for all that share
/// image, factor and cutoff. Holds one image at a time.
class GltfAlpha {
 public:
  /// file_bytes: of the file; pictures that it has far too few bytes for are refused.
  GltfAlpha(const GltfDocument& document, GltfData& data, const std::string& file, uint64_t file_bytes,
            const SceneLoadOptions& options, Surfaces& surfaces);

  /// meshes[mesh].primitives[primitive], which has positions. The same object for each call. Throws Error.
  const GltfSurface& surface(size_t mesh, size_t primitive);

  /// Adds the record of a triangle, of the surface's vertices a, b, c, to the surfaces; its word. Throws
  /// Error.
  uint32_t addTriangle(const GltfSurface& surface, int64_t a, int64_t b, int64_t c);

 private:
  /// Nothing: the mask holds everywhere.
  std::optional<uint32_t> mask(const GltfMaterial& material);
  /// The mask of one hole.
  std::optional<uint32_t> hole();
  const AlphaImage& image(size_t index);
  /// Throws Error when the texels so far are too many for the file.
  void spend(uint64_t texels);
  void readPlaces(const GltfPrimitive& primitive, const std::string& place, GltfSurface& surface);

  const GltfDocument& document_;
  GltfData& data_;
  const std::string& file_;
  uint64_t file_bytes_;         ///< with those of pictures beside the file, so far
  std::set<std::string> uris_;  ///< of these
  uint64_t texels_ = 0;
  const SceneLoadOptions options_;
  Surfaces& surfaces_;
  std::map<std::pair<size_t, size_t>, GltfSurface> of_primitives_;
  std::optional<size_t> last_image_;  ///< the one that is held
  AlphaImage image_;
  /// By image, factor, cutoff and wraps.
  std::map<std::tuple<size_t, double, double, uint32_t>, std::optional<uint32_t>> masks_;
  std::optional<uint32_t> nothing_;  ///< that of hole()
};

}  // namespace sightline
