#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/formats/gltf_document.h"

namespace sightline {

/// What a document wants of a Draco stream.
struct DracoWish {
  struct Attribute {
    uint32_t number = 0;  ///< the stream's own
    GltfComponent component = GltfComponent::kFloat;
    uint32_t width = 1;  ///< components an element
  };
  std::vector<Attribute> attributes;
  GltfComponent corner_component = GltfComponent::kUnsignedInt;  ///< of an unsigned type
};

/// The same in plain bytes, as accessors have it: little endian, without gaps.
struct DracoData {
  uint64_t points = 0;                           ///< elements of each attribute
  uint64_t corners = 0;                          ///< three times the triangles
  std::vector<std::vector<uint8_t>> attributes;  ///< in the wish's order
  std::vector<uint8_t> corner_points;
};

/// Decodes a stream of KHR_draco_mesh_compression. Throws Error that begins with `place` for a stream that is
/// cut off or damaged, or of another kind than a mesh; before memory is taken for counts that it cannot hold.
DracoData decodeDraco(std::span<const uint8_t> stream, const DracoWish& wish, const std::string& place);

}  // namespace sightline
