#pragma once
#include <meshoptimizer.h>

#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sightline::test {

using nlohmann::json;

inline std::string encodeBase64(const std::string& bytes) {
  const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t j = 0; j < 3; ++j) bits = bits << 8 | (i + j < bytes.size() ? uint8_t(bytes[i + j]) : 0u);
    for (size_t j = 0; j < 4; ++j) text += i + j > bytes.size() ? '=' : alphabet[bits >> (18 - 6 * j) & 63];
  }
  return text;
}

template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Writes small glTF files for tests: a document to fill in, and a buffer that grows.
struct GltfFile {
  json document = {{"asset", {{"version", "2.0"}}},
                   {"bufferViews", json::array()},
                   {"accessors", json::array()},
                   {"meshes", json::array()},
                   {"nodes", json::array()}};
  std::string bin;

  size_t addView(const std::string& bytes, uint64_t stride = 0) {
    json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) view["byteStride"] = stride;
    bin += bytes;
    bin.resize((bin.size() + 3) / 4 * 4);
    document["bufferViews"].push_back(view);
    return document["bufferViews"].size() - 1;
  }

  /// A view that is only there compressed; the place holder is buffer 1.
  size_t addCompressed(const std::string& packed, const char* mode, uint64_t stride, uint64_t count,
                       const char* filter = "NONE") {
    addView(packed);
    json& view = document["bufferViews"].back();
    view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                     {"byteOffset", view["byteOffset"]},
                                                     {"byteLength", packed.size()},
                                                     {"mode", mode},
                                                     {"byteStride", stride},
                                                     {"count", count},
                                                     {"filter", filter}};
    view["buffer"] = 1;
    view["byteOffset"] = 0;
    view["byteLength"] = stride * count;
    if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
    return document["bufferViews"].size() - 1;
  }

  size_t addAccessor(size_t view, int component_type, uint64_t count, const char* type) {
    document["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return document["accessors"].size() - 1;
  }

  size_t addPositions(const std::vector<glm::vec3>& positions) {
    return addAccessor(addView(bytesOf(positions)), 5126, positions.size(), "VEC3");
  }

  /// A mesh of one primitive, with a node of that number; returns the number.
  size_t addMesh(size_t positions, int64_t indices, int mode = 4) {
    json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
    if (indices >= 0) primitive["indices"] = indices;
    document["meshes"].push_back({{"primitives", json::array({primitive})}});
    document["nodes"].push_back({{"mesh", document["meshes"].size() - 1}});
    return document["meshes"].size() - 1;
  }

  std::string glb() const {
    json copy = document;
    setBuffer(copy, {{"byteLength", bin.size()}});
    std::string text = copy.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    const auto word = [&](uint64_t value) {
      const uint32_t little = uint32_t(value);
      file.append(reinterpret_cast<const char*>(&little), 4);
    };
    word(2);
    word(12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size()));
    word(text.size());
    file += "JSON" + text;
    if (bin.empty()) return file;
    word(bin.size());
    file.append("BIN\0", 4);
    return file + bin;
  }

  /// As text with a data URI, or with another uri for the buffer.
  std::string gltf(const std::string& uri = "") const {
    json copy = document;
    const std::string data = "data:application/octet-stream;base64," + encodeBase64(bin);
    setBuffer(copy, {{"byteLength", bin.size()}, {"uri", uri.empty() ? data : uri}});
    return copy.dump();
  }

 private:
  static void setBuffer(json& copy, const json& buffer) {
    if (copy.contains("buffers")) return;
    const json holder = {{"byteLength", 1 << 20},
                         {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}};
    copy["buffers"] = json::array({buffer, holder});
  }
};

inline std::vector<glm::vec3> squareCorners() {
  return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
}

/// A square of two triangles with indices of type T.
template <typename T>
GltfFile squareFile(int component_type) {
  GltfFile file;
  const size_t positions = file.addPositions(squareCorners());
  const size_t indices =
      file.addAccessor(file.addView(bytesOf(std::vector<T>{0, 1, 2, 0, 2, 3})), component_type, 6, "SCALAR");
  file.addMesh(positions, int64_t(indices));
  return file;
}

/// The same, compressed by meshoptimizer; indices as a triangle list or as a sequence.
inline GltfFile compressedSquare(bool sequence) {
  const std::vector<glm::vec3> corners = squareCorners();
  const std::vector<uint32_t> indices = {0, 1, 2, 0, 2, 3};
  std::string packed(1000, '\0');
  auto* bytes = reinterpret_cast<unsigned char*>(packed.data());
  const size_t vertex_bytes =
      meshopt_encodeVertexBuffer(bytes, packed.size(), corners.data(), corners.size(), sizeof(glm::vec3));
  GltfFile file;
  const size_t vertex_view =
      file.addCompressed(packed.substr(0, vertex_bytes), "ATTRIBUTES", 12, corners.size());
  const size_t index_bytes =
      sequence ? meshopt_encodeIndexSequence(bytes, packed.size(), indices.data(), indices.size())
               : meshopt_encodeIndexBuffer(bytes, packed.size(), indices.data(), indices.size());
  const size_t index_view = file.addCompressed(
      packed.substr(0, index_bytes), sequence ? "INDICES" : "TRIANGLES", sequence ? 2 : 4, indices.size());
  const size_t positions = file.addAccessor(vertex_view, 5126, corners.size(), "VEC3");
  const size_t accessor = file.addAccessor(index_view, sequence ? 5123 : 5125, indices.size(), "SCALAR");
  file.addMesh(positions, int64_t(accessor));
  file.document["extensionsRequired"] = {"EXT_meshopt_compression"};
  return file;
}

/// Quantised, normalised positions with sparse replacements, a strip, a fan and nested nodes: for mutations.
inline GltfFile richFile() {
  GltfFile file;
  const std::vector<int16_t> quantized = {0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, 0, 32767, 0, 0};
  const size_t positions = file.addAccessor(file.addView(bytesOf(quantized), 8), 5122, 4, "VEC3");
  file.document["accessors"][positions]["normalized"] = true;
  const size_t sparse_indices = file.addView(bytesOf(std::vector<uint8_t>{1, 3}));
  const size_t sparse_values = file.addView(bytesOf(std::vector<int16_t>{16384, 0, 0, 0, 16384, 0}));
  file.document["accessors"][positions]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", sparse_indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", sparse_values}}}};
  const size_t indices =
      file.addAccessor(file.addView(bytesOf(std::vector<uint16_t>{0, 1, 3, 2})), 5123, 4, "SCALAR");
  file.addMesh(positions, int64_t(indices), 5);
  file.addMesh(positions, -1, 6);
  file.document["materials"] = {{{"alphaMode", "MASK"}, {"doubleSided", true}}};
  file.document["meshes"][0]["primitives"][0]["material"] = 0;
  file.document["nodes"][0]["children"] = {1};
  file.document["nodes"][0]["translation"] = {1, 2, 3};
  file.document["nodes"][0]["rotation"] = {0, 0, 1, 0};
  file.document["nodes"][1]["scale"] = {2, 2, 2};
  file.document["scenes"] = {{{"nodes", {0}}}};
  file.document["scene"] = 0;
  file.document["extensionsRequired"] = {"KHR_mesh_quantization"};
  return file;
}

/// A square in a pose: skin with joints of its own, a morph target of sparse values alone, default weights,
/// an invisible node, a mirrored one, glass. For mutations.
inline GltfFile posedFile() {
  GltfFile file = squareFile<uint16_t>(5123);
  const std::vector<uint8_t> joints = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0};
  const std::vector<uint8_t> weights = {128, 127, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 100, 155, 0, 0};
  const std::vector<float> inverse_bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1,
                                           2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0,  0, 0, 1};
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["JOINTS_0"] = file.addAccessor(file.addView(bytesOf(joints)), 5121, 4, "VEC4");
  primitive["attributes"]["WEIGHTS_0"] = file.addAccessor(file.addView(bytesOf(weights)), 5121, 4, "VEC4");
  file.document["accessors"].back()["normalized"] = true;
  const size_t inverse = file.addAccessor(file.addView(bytesOf(inverse_bind)), 5126, 2, "MAT4");
  const size_t sparse_indices = file.addView(bytesOf(std::vector<uint8_t>{0, 2}));
  const size_t sparse_values = file.addView(bytesOf(std::vector<float>{0, 0, 1, 0, 0, 2}));
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", sparse_indices}, {"componentType", 5121}}},
                       {"values", {{"bufferView", sparse_values}}}};
  file.document["accessors"].push_back(
      {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}, {"sparse", sparse}});
  primitive["targets"] = {{{"POSITION", file.document["accessors"].size() - 1}}};
  primitive["material"] = 0;
  file.document["meshes"][0]["weights"] = {0.5};
  file.document["materials"] = {
      {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.9}}}}}}};
  file.document["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  file.document["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {9, 9, 9}}},
                            {{"children", {2}}, {"translation", {1, 2, 3}}},
                            {{"rotation", {0, 0, 1, 0}}},
                            {{"mesh", 0}, {"scale", {-1, 1, 1}}, {"weights", {2}}},
                            {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}}};
  return file;
}

}  // namespace sightline::test
