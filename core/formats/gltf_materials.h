#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/json_object.h"

namespace sightline {

/// An image of a glTF document: its bytes are those of a uri or of a buffer view.
struct GltfImage {
  std::optional<std::string> uri;
  std::optional<size_t> view;
};

/// The texture whose alpha a material's mask is.
struct GltfAlphaTexture {
  std::optional<size_t> image;  ///< without: an extension's alone, of a kind that is not read
  std::string place;            ///< "textures[3]", for messages
  glm::uvec2 wraps{0};          ///< kWrap... (core/shared/surface.h) of x and y
  uint64_t uv_set = 0;          ///< TEXCOORD_n
  // KHR_texture_transform: the place in the image is offset + rotation * (scale * uv).
  glm::dvec2 offset{0.0};
  double rotation = 0.0;  ///< radians, counter-clockwise
  glm::dvec2 scale{1.0};
};

struct GltfMaterial {
  enum class Alpha { kOpaque, kMask, kBlend };
  Alpha alpha = Alpha::kOpaque;
  bool glass = false;  ///< KHR_materials_transmission lets light through
  bool double_sided = false;
  // Of masks:
  double cutoff = 0.5;
  double factor = 1.0;                      ///< times the texture's alpha
  std::optional<GltfAlphaTexture> texture;  ///< without: the factor alone
  std::string place;                        ///< "materials[2]"
};

/// The materials, with every index in range. Throws Error with file and place.
std::vector<GltfMaterial> readMaterials(const JsonObject& document);

std::vector<GltfImage> readImages(const JsonObject& document, size_t views);

}  // namespace sightline
