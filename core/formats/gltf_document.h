#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/gltf_materials.h"

namespace sightline {

// What geometry needs of a glTF 2.0 document, with defaults filled in and every index in range. Names follow
// the format's own. Of textures only those of alpha masks are looked at; animations, cameras and lights are
// not.

struct GltfBuffer {
  std::optional<std::string> uri;  ///< without: the GLB's chunk, or a place holder for compressed views
  uint64_t byte_length = 0;
};

/// EXT_meshopt_compression or KHR_meshopt_compression of a buffer view.
struct GltfCompression {
  enum class Mode { kAttributes, kTriangles, kIndices };
  enum class Filter { kNone, kOctahedral, kQuaternion, kExponential, kColor };
  const char* extension = "";  ///< its name
  size_t buffer = 0;
  uint64_t byte_offset = 0;
  uint64_t byte_length = 0;
  uint64_t byte_stride = 0;
  uint64_t count = 0;
  Mode mode = Mode::kAttributes;
  Filter filter = Filter::kNone;
};

struct GltfBufferView {
  size_t buffer = 0;
  uint64_t byte_offset = 0;
  uint64_t byte_length = 0;
  uint64_t byte_stride = 0;  ///< 0: elements follow one another
  std::optional<GltfCompression> compression;
};

/// The component types, with the format's numbers.
enum class GltfComponent : uint32_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

struct GltfSparse {
  uint64_t count = 0;
  size_t indices_view = 0;
  uint64_t indices_offset = 0;
  GltfComponent indices_component = GltfComponent::kUnsignedInt;
  size_t values_view = 0;
  uint64_t values_offset = 0;
};

struct GltfAccessor {
  std::optional<size_t> view;  ///< without: all zeros
  uint64_t byte_offset = 0;
  GltfComponent component = GltfComponent::kFloat;
  bool normalized = false;
  uint64_t count = 0;
  uint32_t width = 1;  ///< components an element
  std::optional<GltfSparse> sparse;
};

/// KHR_draco_mesh_compression: a stream that stands for accessors without data of their own.
struct GltfDraco {
  size_t view = 0;
  std::vector<std::pair<size_t, uint32_t>> attributes;  ///< accessors, and their numbers in the stream
};

struct GltfPrimitive {
  std::optional<size_t> positions;  ///< accessor
  std::optional<size_t> indices;    ///< accessor
  GltfMaterial material;
  std::optional<size_t> mask_uv;               ///< accessor: TEXCOORD_n of the material's alpha texture
  std::vector<std::optional<size_t>> targets;  ///< accessor of each morph target's POSITION
  std::vector<size_t> joints, weights;         ///< accessors JOINTS_0, ..., WEIGHTS_0, ...: as many of either
  std::optional<GltfDraco> draco;              ///< only where an accessor needs it
  uint32_t mode = 4;                           ///< 4 triangles, 5 strip, 6 fan; below: points and lines
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
  std::vector<double> weights;  ///< of the morph targets; empty: all 0
};

struct GltfSkin {
  std::vector<size_t> joints;          ///< nodes, at least one
  std::optional<size_t> inverse_bind;  ///< accessor; without: identity
};

/// EXT_mesh_gpu_instancing: accessors of as many elements as the node's mesh has instances.
struct GltfInstancing {
  std::optional<size_t> translation, rotation, scale;
  uint64_t count = 0;
};

struct GltfNode {
  std::string name;
  std::optional<size_t> mesh;
  std::optional<size_t> skin;
  std::optional<std::vector<double>> weights;  ///< in place of the mesh's
  bool visible = true;                         ///< KHR_node_visibility; holds for the children too
  std::vector<size_t> children;
  std::optional<GltfInstancing> instancing;
  std::vector<size_t> coarser;  ///< MSFT_lod: nodes that take its place farther away
  glm::dmat4 local{1.0};        ///< to the parent's space
};

struct GltfDocument {
  std::vector<GltfBuffer> buffers;
  std::vector<GltfBufferView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfImage> images;
  std::vector<GltfMesh> meshes;
  std::vector<GltfSkin> skins;
  std::vector<GltfNode> nodes;
  std::vector<size_t> roots;  ///< nodes of the default scene; the first scene if none is named; without
                              ///< scenes every node that is no other's child
  glm::dvec3 center{0.0};     ///< of CESIUM_RTC, y up: added to all coordinates
  std::vector<std::string> warnings;
};

/// Corners in the list of a primitive with positions: its indices, or its vertices.
uint64_t cornerCountOf(const GltfDocument& document, const GltfPrimitive& primitive);
/// Triangles that so many corners make by a mode of 4, 5 or 6.
uint64_t triangleCountOf(uint32_t mode, uint64_t corners);
/// Of a primitive: none of points and lines, and without positions.
uint64_t triangleCountOf(const GltfDocument& document, const GltfPrimitive& primitive);

/// The matrix of a translation, a rotation by the quaternion x, y, z, w, and a scale. A quaternion that is
/// not quite unit is scaled to it; one of zeros turns nothing.
glm::dmat4 gltfPlace(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale);

/// Reads and checks the document. Errors name file and place: "a.gltf: accessors[3].count: ...". ignored:
/// extensions that may be required although they are unknown.
GltfDocument readGltfDocument(const nlohmann::json& document, const std::string& file,
                              const std::vector<std::string>& ignored = {});

}  // namespace sightline
