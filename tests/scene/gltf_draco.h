#pragma once
#include <draco/compression/encode.h>
#include <draco/core/encoder_buffer.h>
#include <draco/mesh/mesh.h>

#include <stdexcept>
#include <vector>

#include "tests/scene/gltf_files.h"

namespace sightline::test {

/// A bumpy sheet of side x side squares, and glTF files that hold it as a Draco stream, written by libdraco.
struct DracoGrid {
  explicit DracoGrid(int side) {
    for (int y = 0; y <= side; ++y) {
      for (int x = 0; x <= side; ++x) positions.emplace_back(x, y, float(x * y % 3) * 0.25f);
    }
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const auto a = uint32_t(y * (side + 1) + x), c = a + uint32_t(side) + 1;
        triangles.push_back({a, a + 1, c + 1});
        triangles.push_back({a, c + 1, c});
      }
    }
  }

  /// Lossless; `skinned`: vertices hang on joints 0 and 1 by turns.
  GltfFile file(bool edgebreaker, bool skinned = false) const {
    draco::Mesh mesh;
    mesh.set_num_points(uint32_t(positions.size()));
    const int position =
        addAttribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, bytesOf(positions));
    std::vector<uint8_t> joints, weights;
    for (size_t i = 0; i < positions.size(); ++i) {
      joints.insert(joints.end(), {uint8_t(i % 2), 0, 0, 0});
      weights.insert(weights.end(), {255, 0, 0, 0});
    }
    int joint = 0, weight = 0;
    if (skinned) {
      joint = addAttribute(mesh, draco::GeometryAttribute::GENERIC, draco::DT_UINT8, bytesOf(joints));
      weight = addAttribute(mesh, draco::GeometryAttribute::GENERIC, draco::DT_UINT8, bytesOf(weights));
    }
    for (const glm::uvec3& t : triangles) {
      mesh.AddFace({draco::PointIndex(t.x), draco::PointIndex(t.y), draco::PointIndex(t.z)});
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                          : draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) throw std::runtime_error("draco cannot encode");

    GltfFile result;
    const size_t view = result.addView(std::string(buffer.data(), buffer.size()));
    const auto accessor = [&](int component, size_t count, const char* type) {
      result.document["accessors"].push_back(
          {{"componentType", component}, {"count", count}, {"type", type}});
      return result.document["accessors"].size() - 1;
    };
    const size_t positions_at = accessor(5126, positions.size(), "VEC3");
    result.addMesh(positions_at, int64_t(accessor(5125, triangles.size() * 3, "SCALAR")));
    json& primitive = result.document["meshes"][0]["primitives"][0];
    json numbers = {{"POSITION", mesh.attribute(position)->unique_id()}};
    if (skinned) {
      primitive["attributes"]["JOINTS_0"] = accessor(5121, positions.size(), "VEC4");
      primitive["attributes"]["WEIGHTS_0"] = accessor(5121, positions.size(), "VEC4");
      result.document["accessors"].back()["normalized"] = true;
      numbers["JOINTS_0"] = mesh.attribute(joint)->unique_id();
      numbers["WEIGHTS_0"] = mesh.attribute(weight)->unique_id();
    }
    primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view}, {"attributes", numbers}};
    result.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return result;
  }

  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;

 private:
  int addAttribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data,
                   const std::string& bytes) const {
    const size_t each = bytes.size() / positions.size();
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, uint8_t(each / size_t(draco::DataTypeLength(data))), data, false,
                   int64_t(each), 0);
    const int id = mesh.AddAttribute(attribute, true, uint32_t(positions.size()));
    for (uint32_t i = 0; i < positions.size(); ++i) {
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), bytes.data() + i * each);
    }
    return id;
  }
};

}  // namespace sightline::test
