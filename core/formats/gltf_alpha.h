#pragma once
#include <map>
#include <optional>
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
/// image and cutoff.
class GltfAlpha {
 public:
  GltfAlpha(const GltfDocument& document, GltfData& data, const std::string& file,
            const SceneLoadOptions& options, Surfaces& surfaces);

  /// meshes[mesh].primitives[primitive], which has positions. The same object for each call. Throws Error.
  const GltfSurface& surface(size_t mesh, size_t primitive);

  /// Adds the record of a triangle, of the surface's vertices a, b, c, to the surfaces; its word. Throws
  /// Error.
  uint32_t addTriangle(const GltfSurface& surface, int64_t a, int64_t b, int64_t c);

 private:
  /// Nothing: the mask holds everywhere.
  std::optional<uint32_t> mask(const GltfMaterial& material);
  const AlphaImage& image(const GltfAlphaTexture& texture);
  void readPlaces(const GltfPrimitive& primitive, const std::string& place, GltfSurface& surface);

  const GltfDocument& document_;
  GltfData& data_;
  const std::string& file_;
  const SceneLoadOptions options_;
  Surfaces& surfaces_;
  std::map<std::pair<size_t, size_t>, GltfSurface> of_primitives_;
  std::map<size_t, AlphaImage> images_;
  /// By image, what must be below the cutoff (factor and cutoff) and wraps.
  std::map<std::tuple<size_t, double, double, uint32_t>, std::optional<uint32_t>> masks_;
  std::optional<uint32_t> nothing_;  ///< the mask of one hole
};

}  // namespace sightline
