#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "core/formats/gltf_data.h"
#include "core/strip/gltf_packer.h"
#include "core/strip/gltf_uses.h"

namespace sightline {

/// Corners of the triangles of one primitive: numbers of its vertices, three a triangle.
struct PrimitiveCorners {
  size_t mesh = 0, primitive = 0;
  std::vector<uint32_t> corners;
};

/// Takes vertices that no corner uses out of the accessors of these primitives, and gives the corners the new
/// numbers. Primitives that share an accessor of vertices do so together; those whose accessors have other
/// uses, are sparse or filtered, or that share one with a primitive that is not in the list, are left as
/// they are: returns how many. Throws Error that names `file`.
uint64_t compactVertices(const GltfDocument& document, const nlohmann::json& root, GltfData& data,
                         std::vector<PrimitiveCorners>& primitives, GltfPacker& packer,
                         const std::string& file);

/// Accessors of vertices (attributes and morph targets) that only primitives that are `gone` use.
std::vector<size_t> unusedVertexAccessors(const nlohmann::json& root, const std::vector<MeshPlan>& plans);

}  // namespace sightline
