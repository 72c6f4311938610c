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

/// Extensions that a file may require because they move no triangle: materials, textures, lights, meta data,
/// sound, physics, what an engine does with a node. A name that ends in '_' stands for all that begin so.
constexpr std::array kLeaveGeometry = {
    "ADOBE_materials_",
    "AGI_articulations",
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_materials_",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_ngon_encoding",
    "GODOT_single_root",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_audio_emitter",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_technique_webgl",
    "KHR_techniques_webgl",
    "KHR_texture_",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MOZ_",
    "MSFT_audio_emitter",
    "MSFT_packing_",
    "MSFT_texture_",
    "NV_materials_",
    "OMI_",
    "VRMC_",
};

/// Extensions that change triangles, and are read.
constexpr std::array kRead = {"CESIUM_RTC",
                              "EXT_mesh_gpu_instancing",
                              "EXT_meshopt_compression",
                              "KHR_draco_mesh_compression",
                              "KHR_mesh_quantization",
                              "KHR_meshopt_compression",
                              "KHR_node_visibility",
                              "MSFT_lod"};

bool isKnown(std::string_view extension) {
  for (const std::string_view name : kLeaveGeometry) {
    if (name.ends_with('_') ? extension.starts_with(name) : extension == name) return true;
  }
  return std::find(kRead.begin(), kRead.end(), extension) != kRead.end();
}

void checkRequirements(const JsonObject& document, const std::vector<std::string>& ignored) {
  const JsonObject asset = document.requiredObject("asset");
  const std::string version = asset.isNumber("version") ? fmt::format("{}", *asset.real("version"))
                                                        : asset.text("version").value_or("");
  if (!version.starts_with("2.")) {
    document.fail("asset.version", fmt::format("\"{}\" is not supported, only glTF 2; convert the file",
                                               cleanName(version.substr(0, 20))));
  }
  for (const std::string& extension : document.texts("extensionsRequired")) {
    if (isKnown(extension) || std::find(ignored.begin(), ignored.end(), extension) != ignored.end()) continue;
    document.fail("extensionsRequired",
                  fmt::format("{} is unknown; convert the file without it, or load it without what it adds "
                              "(--ignore-extension)",
                              nlohmann::json(cleanName(extension.substr(0, 100))).dump()));
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

GltfCompression readCompression(const JsonObject& object, const char* extension, size_t buffers) {
  using Mode = GltfCompression::Mode;
  using Filter = GltfCompression::Filter;
  GltfCompression result;
  result.extension = extension;
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
  if (filter != "NONE" && filter != "OCTAHEDRAL" && filter != "QUATERNION" && filter != "EXPONENTIAL" &&
      filter != "COLOR") {
    object.fail("filter", "expected NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR");
  }
  result.mode =
      mode == "ATTRIBUTES" ? Mode::kAttributes : (mode == "TRIANGLES" ? Mode::kTriangles : Mode::kIndices);
  result.filter = filter == "NONE"         ? Filter::kNone
                  : filter == "OCTAHEDRAL" ? Filter::kOctahedral
                  : filter == "QUATERNION" ? Filter::kQuaternion
                  : filter == "COLOR"      ? Filter::kColor
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
  for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto compression = extensionOf(object, extension);
    if (compression && !view.compression)
      view.compression = readCompression(*compression, extension, buffers);
  }
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

/// The stream of a primitive; nothing where all accessors that make triangles have data of their own: then
/// what is compressed is the same again, for those who read it.
std::optional<GltfDraco> readDraco(const JsonObject& object, const JsonObject& attributes,
                                   const GltfPrimitive& primitive, const GltfDocument& document) {
  const auto extension = extensionOf(object, "KHR_draco_mesh_compression");
  if (!extension) return std::nullopt;
  const auto has_data = [&](const std::optional<size_t>& accessor) {
    return !accessor || document.accessors[*accessor].view.has_value();
  };
  if (has_data(primitive.positions) && has_data(primitive.indices)) return std::nullopt;
  GltfDraco draco;
  draco.view = extension->requiredIndex("bufferView", document.views.size());
  const JsonObject numbers = extension->requiredObject("attributes");
  for (const std::string& name : numbers.keys()) {
    const auto accessor = attributes.index(name.c_str(), document.accessors.size());
    const bool is_mask_uv = accessor && accessor == primitive.mask_uv;
    if (name != "POSITION" && !name.starts_with("JOINTS_") && !name.starts_with("WEIGHTS_") && !is_mask_uv)
      continue;
    const uint64_t number = numbers.requiredNumber(name.c_str());
    if (number > 0xffffffff) numbers.fail(name, "expected a number below 2^32");
    if (accessor && !has_data(accessor)) draco.attributes.emplace_back(*accessor, uint32_t(number));
  }
  if (primitive.mode != 4 && primitive.mode != 5) {
    extension->fail("compresses triangles only, and the primitive's mode is neither 4 nor 5");
  }
  return draco;
}

GltfPrimitive readPrimitive(const JsonObject& object, const GltfDocument& document,
                            const std::vector<GltfMaterial>& materials) {
  const size_t accessors = document.accessors.size();
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
  primitive.draco = readDraco(object, attributes, primitive, document);
  if (primitive.draco) primitive.mode = 4;  // a stream holds triangles, whatever became of them later
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

GltfMesh readMesh(const JsonObject& object, const GltfDocument& document,
                  const std::vector<GltfMaterial>& materials) {
  GltfMesh mesh;
  mesh.name = object.text("name").value_or("");
  for (const JsonObject& primitive : object.objects("primitives")) {
    mesh.primitives.push_back(readPrimitive(primitive, document, materials));
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
  const auto vector = [](const std::vector<double>& v) { return glm::dvec3(v[0], v[1], v[2]); };
  const std::vector<double> q = rotation.value_or(std::vector<double>{0, 0, 0, 1});
  return gltfPlace(translation ? vector(*translation) : glm::dvec3(0.0), {q[0], q[1], q[2], q[3]},
                   scale ? vector(*scale) : glm::dvec3(1.0));
}

/// Whether the node is turned by a quaternion of zeros, which is no rotation.
bool hasZeroRotation(const JsonObject& object) {
  const auto rotation = object.numbers("rotation", 4);
  return rotation && *rotation == std::vector<double>(4, 0.0);
}

std::optional<GltfInstancing> readInstancing(const JsonObject& object, const GltfDocument& document) {
  const auto extension = extensionOf(object, "EXT_mesh_gpu_instancing");
  if (!extension) return std::nullopt;
  const JsonObject attributes = extension->requiredObject("attributes");
  const size_t accessors = document.accessors.size();
  GltfInstancing instancing;
  instancing.translation = attributes.index("TRANSLATION", accessors);
  instancing.rotation = attributes.index("ROTATION", accessors);
  instancing.scale = attributes.index("SCALE", accessors);
  std::optional<uint64_t> count;
  for (const std::string& name : attributes.keys()) {
    const uint64_t its = document.accessors[attributes.requiredIndex(name.c_str(), accessors)].count;
    if (count && *count != its) {
      attributes.fail(name, fmt::format("{} elements, another attribute has {}", its, *count));
    }
    count = its;
  }
  if (!count) attributes.fail("expected TRANSLATION, ROTATION or SCALE");
  instancing.count = *count;
  return instancing;
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
  node.instancing = readInstancing(object, document);
  const auto lod = extensionOf(object, "MSFT_lod");
  if (lod) node.coarser = lod->indices("ids", nodes);
  return node;
}

std::vector<size_t> readRoots(const JsonObject& document, const std::vector<GltfNode>& nodes) {
  const std::vector<JsonObject> scenes = document.objects("scenes");
  if (!scenes.empty()) {  // some files name a scene without having one
    return scenes[document.index("scene", scenes.size()).value_or(0)].indices("nodes", nodes.size());
  }
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

glm::dmat4 gltfPlace(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale) {
  glm::dmat4 m(1.0);
  if (rotation != glm::dvec4(0.0)) {
    const double x = rotation.x;
    const double y = rotation.y;
    const double z = rotation.z;
    const double w = rotation.w;
    const double s = 2.0 / (x * x + y * y + z * z + w * w);
    m[0] = {1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), 0.0};
    m[1] = {s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w), 0.0};
    m[2] = {s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y), 0.0};
  }
  for (int i = 0; i < 3; ++i) m[i] *= scale[i];
  m[3] = glm::dvec4(translation, 1.0);
  return m;
}

GltfDocument readGltfDocument(const nlohmann::json& root, const std::string& file,
                              const std::vector<std::string>& ignored) {
  const JsonObject document(root, file, "");
  checkRequirements(document, ignored);
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
    result.meshes.push_back(readMesh(object, result, materials));
  }
  const std::vector<JsonObject> nodes = document.objects("nodes");
  for (const JsonObject& object : document.objects("skins")) {
    result.skins.push_back(readSkin(object, result.accessors.size(), nodes.size()));
  }
  uint64_t zero_rotations = 0;
  for (const JsonObject& object : nodes) {
    result.nodes.push_back(readNode(object, result, nodes.size()));
    zero_rotations += hasZeroRotation(object) ? 1 : 0;
  }
  if (zero_rotations != 0) {
    result.warnings.push_back(
        fmt::format("nodes whose rotation is a quaternion of zeros, not turned: {}", zero_rotations));
  }
  result.roots = readRoots(document, result.nodes);
  const auto rtc = extensionOf(document, "CESIUM_RTC");
  const auto center = rtc ? rtc->numbers("center", 3) : std::nullopt;
  if (center) result.center = {(*center)[0], (*center)[2], -(*center)[1]};  // it has z up
  return result;
}

uint64_t cornerCountOf(const GltfDocument& document, const GltfPrimitive& primitive) {
  return document.accessors[primitive.indices ? *primitive.indices : *primitive.positions].count;
}

uint64_t triangleCountOf(uint32_t mode, uint64_t corners) {
  if (mode == 4) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

uint64_t triangleCountOf(const GltfDocument& document, const GltfPrimitive& primitive) {
  if (primitive.mode < 4 || !primitive.positions) return 0;
  return triangleCountOf(primitive.mode, cornerCountOf(document, primitive));
}

}  // namespace sightline
