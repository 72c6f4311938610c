// Based on: G. Turk, The PLY Polygon File Format, 1994.
#include <fmt/format.h>

#include <cstring>
#include <string>

#include "core/base/error.h"
#include "core/export/voxel_export.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

constexpr size_t kPlyPiece = 1 << 20;  // bytes, about, that are written at once

class PlyBytes {
 public:
  explicit PlyBytes(OutputFile& file) : file_(file) {}
  template <typename Number>
  void add(Number value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    buffer_.append(bytes, sizeof(value));
    if (buffer_.size() >= kPlyPiece) flush();
  }
  void flush() {
    file_.write(buffer_);
    buffer_.clear();
  }

 private:
  OutputFile& file_;
  std::string buffer_;
};

}  // namespace

void savePly(const VoxelMesh& mesh, const glm::dvec3& offset, const std::filesystem::path& file) {
  if (mesh.positions.size() > 0x7fffffff) {
    throw Error(fmt::format("{}: {} corners are too many for a PLY: take a coarser level", file.string(),
                            mesh.positions.size()));
  }
  const bool moved = offset != glm::dvec3(0.0);
  OutputFile output(file);
  const std::string type = moved ? "double" : "float";
  output.write(
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\n"
                  "property {} z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  mesh.positions.size(), type, type, type, mesh.faces.size()));
  PlyBytes bytes(output);
  for (const glm::vec3& position : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      if (moved) {
        bytes.add(double(position[axis]) + offset[axis]);
      } else {
        bytes.add(position[axis]);
      }
    }
  }
  for (const glm::uvec4& face : mesh.faces) {
    bytes.add(uint8_t(4));
    for (int k = 0; k < 4; ++k) bytes.add(int32_t(face[k]));
  }
  bytes.flush();
  output.commit();
}

}  // namespace sightline
