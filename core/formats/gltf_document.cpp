// Based on: Khronos Group, glTF 2.0 Specification, 2021; EXT_meshopt_compression. The document is read from
// JSON here rather than by tinygltf: Debian's version rejects the fallback buffers of
// EXT_meshopt_compression, reads beyond truncated GLB files and recurses over "extras" without bound.
#include "core/formats/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "core/formats/json_object.h"
#include "core/formats/scene_builder.h"

namespace sightline {
namespace {

/// Extensions that a file may require because they change no triangle: materials, textures, lights, meta
/// data.
bool leavesGeometry(const std::string& extension) {
  constexpr std::array<const char*, 8> kPrefixes = {"KHR_materials_", "KHR_texture_",         "EXT_texture_",
                                                    "MSFT_texture_",  "KHR_lights_",          "EXT_lights_",
                                                    "KHR_xmp",        "KHR_animation_pointer"};
  for (const char* prefix : kPrefixes) {
    if (extension.starts_with(prefix)) return true;
  }
  return false;
}

void checkRequirements(const JsonObject& document) {
  const std::string version = document.requiredObject("asset").text("version").value_or("");
  if (!version.starts_with("2.")) {
    document.fail("asset.version",
                  fmt::format("\"{}\" is not supported, only glTF 2", cleanName(version.substr(0, 20))));
  }
  for (const std::string& extension : document.texts("extensionsRequired")) {
    if (extension == "EXT_meshopt_compression" || extension == "KHR_mesh_quantization" ||
        extension == "KHR_node_visibility" || leavesGeometry(extension)) {
      continue;
    }
    document.fail("extensionsRequired", fmt::format("{} is not supported; convert the file without it",
                                                    nlohmann::json(extension).dump()));
  }
}

/// An object's extension of that name.
std::optional<JsonObject> extensionOf(const JsonObject& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

GltfBuffer readBuffer(const JsonObject& object) {
  GltfBuffer buffer;
  buffer.uri = object.text("uri");
  buffer.byte_length = object.requiredNumber("byteLength");
  return buffer;
}

GltfCompression readCompression(const JsonObject& object, size_t buffers) {
  using Mode = GltfCompression::Mode;
  using Filter = GltfCompression::Filter;
  GltfCompression result;
  result.buffer = object.requiredIndex("buffer", buffers);
  result.byte_offset = object.number("byteOffset").value_or(0);
  result.byte_length = object.requiredNumber("byteLength");
  result.byte_stride = object.requiredNumber("byteStride");
  result.count = object.requiredNumber("count");
  const std::string mode = object.text("mode").value_or("");
  const std::string filter = object.text("filter").value_or("NONE");
  if (mode != "ATTRIBUTES" && mode != "TRIANGLES" && mode != "INDICES") {
    object.fail("mode", "expected ATTRIBUTES, TRIANGLES or INDICES");
  }
  if (filter != "NONE" && filter != "OCTAHEDRAL" && filter != "QUATERNION" && filter != "EXPONENTIAL") {
    object.fail("filter", "expected NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
  }
  result.mode =
      mode == "ATTRIBUTES" ? Mode::kAttributes : (mode == "TRIANGLES" ? Mode::kTriangles : Mode::kIndices);
  result.filter = filter == "NONE"         ? Filter::kNone
                  : filter == "OCTAHEDRAL" ? Filter::kOctahedral
                  : filter == "QUATERNION" ? Filter::kQuaternion
                                           : Filter::kExponential;
  if (result.filter != Filter::kNone && result.mode != Mode::kAttributes) {
    object.fail("filter", "must be NONE unless the mode is ATTRIBUTES");
  }
  return result;
}

GltfBufferView readView(const JsonObject& object, size_t buffers) {
  GltfBufferView view;
  view.buffer = object.requiredIndex("buffer", buffers);
  view.byte_offset = object.number("byteOffset").value_or(0);
  view.byte_length = object.requiredNumber("byteLength");
  view.byte_stride = object.number("byteStride").value_or(0);
  if (view.byte_stride > 252) object.fail("byteStride", fmt::format("{} is more than 252", view.byte_stride));
  const auto compression = extensionOf(object, "EXT_meshopt_compression");
  if (compression) view.compression = readCompression(*compression, buffers);
  return view;
}

GltfComponent readComponent(const JsonObject& object) {
  const uint64_t number = object.requiredNumber("componentType");
  if (number < 5120 || number > 5126 || number == 5124) {
    object.fail("componentType", fmt::format("{} is none of 5120, 5121, 5122, 5123, 5125, 5126", number));
  }
  return GltfComponent(number);
}

GltfSparse readSparse(const JsonObject& object, uint64_t elements, size_t views) {
  GltfSparse sparse;
  sparse.count = object.requiredNumber("count");
  if (sparse.count == 0 || sparse.count > elements)
    object.fail("count", "expected 1 to the accessor's count");
  const JsonObject indices = object.requiredObject("indices");
  sparse.indices_view = indices.requiredIndex("bufferView", views);
  sparse.indices_offset = indices.number("byteOffset").value_or(0);
  sparse.indices_component = readComponent(indices);
  const JsonObject values = object.requiredObject("values");
  sparse.values_view = values.requiredIndex("bufferView", views);
  sparse.values_offset = values.number("byteOffset").value_or(0);
  return sparse;
}

GltfAccessor readAccessor(const JsonObject& object, size_t views) {
  GltfAccessor accessor;
  accessor.view = object.index("bufferView", views);
  accessor.byte_offset = object.number("byteOffset").value_or(0);
  accessor.component = readComponent(object);
  accessor.normalized = object.boolean("normalized", false);
  accessor.count = object.requiredNumber("count");
  const std::string type = object.text("type").value_or("");
  constexpr std::array<std::pair<const char*, uint32_t>, 7> kTypes = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  accessor.width = 0;
  for (const auto& [name, width] : kTypes) {
    if (type == name) accessor.width = width;
  }
  if (accessor.width == 0) object.fail("type", "expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
  const auto sparse = object.object("sparse");
  if (sparse) accessor.sparse = readSparse(*sparse, accessor.count, views);
  return accessor;
}

/// JOINTS_n and WEIGHTS_n for n = 0, 1, ...
void readInfluences(const JsonObject& attributes, size_t accessors, GltfPrimitive& primitive) {
  for (size_t set = 0;; ++set) {
    const std::string joints = fmt::format("JOINTS_{}", set);
    const std::string weights = fmt::format("WEIGHTS_{}", set);
    if (!attributes.has(joints.c_str()) && !attributes.has(weights.c_str())) return;
    primitive.joints.push_back(attributes.requiredIndex(joints.c_str(), accessors));
    primitive.weights.push_back(attributes.requiredIndex(weights.c_str(), accessors));
  }
}

GltfPrimitive readPrimitive(const JsonObject& object, size_t accessors,
                            const std::vector<GltfMaterial>& materials) {
  GltfPrimitive primitive;
  const JsonObject attributes = object.requiredObject("attributes");
  primitive.positions = attributes.index("POSITION", accessors);
  primitive.indices = object.index("indices", accessors);
  primitive.mode = uint32_t(std::min<uint64_t>(object.number("mode").value_or(4), 7));
  if (primitive.mode > 6) object.fail("mode", "expected 0 to 6");
  const auto material = object.index("material", materials.size());
  if (material) primitive.material = materials[*material];
  if (primitive.material.texture) {
    const std::string uv = fmt::format("TEXCOORD_{}", primitive.material.texture->uv_set);
    primitive.mask_uv = attributes.index(uv.c_str(), accessors);
  }
  for (const JsonObject& target : object.objects("targets")) {
    primitive.targets.push_back(target.index("POSITION", accessors));
  }
  readInfluences(attributes, accessors, primitive);
  const auto extensions = object.object("extensions");
  if (extensions && extensions->has("KHR_draco_mesh_compression")) {
    object.fail("KHR_draco_mesh_compression is not supported; convert the file without it");
  }
  return primitive;
}

/// A weight for each morph target; empty if the key is missing.
std::optional<std::vector<double>> readWeights(const JsonObject& object, const GltfMesh& mesh) {
  std::optional<std::vector<double>> weights = object.numbers("weights");
  if (!weights) return weights;
  for (const GltfPrimitive& primitive : mesh.primitives) {
    if (primitive.targets.empty() || primitive.targets.size() == weights->size()) continue;
    object.fail("weights",
                fmt::format("{} numbers for {} morph targets", weights->size(), primitive.targets.size()));
  }
  return weights;
}

GltfMesh readMesh(const JsonObject& object, size_t accessors, const std::vector<GltfMaterial>& materials) {
  GltfMesh mesh;
  mesh.name = object.text("name").value_or("");
  for (const JsonObject& primitive : object.objects("primitives")) {
    mesh.primitives.push_back(readPrimitive(primitive, accessors, materials));
  }
  mesh.weights = readWeights(object, mesh).value_or(std::vector<double>());
  return mesh;
}

GltfSkin readSkin(const JsonObject& object, size_t accessors, size_t nodes) {
  GltfSkin skin;
  skin.joints = object.indices("joints", nodes);
  if (skin.joints.empty()) object.fail("joints", "expected at least one");
  skin.inverse_bind = object.index("inverseBindMatrices", accessors);
  return skin;
}

/// A unit quaternion's matrix; one that is not quite unit is scaled to it.
glm::dmat4 rotationMatrix(const std::vector<double>& q) {
  const double s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double x = q[0];
  const double y = q[1];
  const double z = q[2];
  const double w = q[3];
  glm::dmat4 m(1.0);
  m[0] = {1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), 0.0};
  m[1] = {s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w), 0.0};
  m[2] = {s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y), 0.0};
  return m;
}

glm::dmat4 readTransform(const JsonObject& object) {
  const auto matrix = object.numbers("matrix", 16);
  const auto translation = object.numbers("translation", 3);
  const auto rotation = object.numbers("rotation", 4);
  const auto scale = object.numbers("scale", 3);
  if (matrix) {
    if (translation || rotation || scale) object.fail("has a matrix and translation, rotation or scale");
    glm::dmat4 result;
    for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = (*matrix)[size_t(i)];
    if (result[0][3] != 0.0 || result[1][3] != 0.0 || result[2][3] != 0.0 || result[3][3] != 1.0) {
      object.fail("matrix", "the last row is not 0 0 0 1");
    }
    return result;
  }
  if (rotation && *rotation == std::vector<double>(4, 0.0)) object.fail("rotation", "the quaternion is zero");
  glm::dmat4 result(1.0);
  if (rotation) result = rotationMatrix(*rotation);
  if (scale) {
    for (int i = 0; i < 3; ++i) result[i] *= (*scale)[size_t(i)];
  }
  if (translation) result[3] = {(*translation)[0], (*translation)[1], (*translation)[2], 1.0};
  return result;
}

GltfNode readNode(const JsonObject& object, const GltfDocument& document, size_t nodes) {
  GltfNode node;
  node.name = object.text("name").value_or("");
  node.mesh = object.index("mesh", document.meshes.size());
  node.skin = object.index("skin", document.skins.size());
  if (node.mesh) node.weights = readWeights(object, document.meshes[*node.mesh]);
  const auto visibility = extensionOf(object, "KHR_node_visibility");
  node.visible = !visibility || visibility->boolean("visible", true);
  node.children = object.indices("children", nodes);
  node.local = readTransform(object);
  const auto extensions = object.object("extensions");
  if (extensions && extensions->has("EXT_mesh_gpu_instancing")) {
    object.fail("EXT_mesh_gpu_instancing is not supported; convert the file without it");
  }
  return node;
}

std::vector<size_t> readRoots(const JsonObject& document, const std::vector<GltfNode>& nodes) {
  const std::vector<JsonObject> scenes = document.objects("scenes");
  const std::optional<size_t> chosen = document.index("scene", scenes.size());
  if (!scenes.empty()) return scenes[chosen.value_or(0)].indices("nodes", nodes.size());
  std::vector<bool> is_child(nodes.size(), false);
  for (const GltfNode& node : nodes) {
    for (const size_t child : node.children) is_child[child] = true;
  }
  std::vector<size_t> roots;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!is_child[i]) roots.push_back(i);
  }
  return roots;
}

}  // namespace

GltfDocument readGltfDocument(const nlohmann::json& root, const std::string& file) {
  const JsonObject document(root, file, "");
  checkRequirements(document);
  GltfDocument result;
  for (const JsonObject& object : document.objects("buffers")) result.buffers.push_back(readBuffer(object));
  for (const JsonObject& object : document.objects("bufferViews")) {
    result.views.push_back(readView(object, result.buffers.size()));
  }
  for (const JsonObject& object : document.objects("accessors")) {
    result.accessors.push_back(readAccessor(object, result.views.size()));
  }
  const std::vector<GltfMaterial> materials = readMaterials(document);
  if (std::ranges::any_of(materials, [](const GltfMaterial& m) { return m.texture && m.texture->image; })) {
    result.images = readImages(document, result.views.size());
  }
  for (const JsonObject& object : document.objects("meshes")) {
    result.meshes.push_back(readMesh(object, result.accessors.size(), materials));
  }
  const std::vector<JsonObject> nodes = document.objects("nodes");
  for (const JsonObject& object : document.objects("skins")) {
    result.skins.push_back(readSkin(object, result.accessors.size(), nodes.size()));
  }
  for (const JsonObject& object : nodes) {
    result.nodes.push_back(readNode(object, result, nodes.size()));
  }
  result.roots = readRoots(document, result.nodes);
  return result;
}

}  // namespace sightline
