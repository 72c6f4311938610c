#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>

#include "core/strip/gltf_packer.h"

namespace sightline {
namespace {

/// The numbers as meshoptimizer takes them.
std::vector<unsigned> indicesOf(std::string_view values, uint64_t stride) {
  std::vector<unsigned> indices(values.size() / stride, 0);
  for (size_t i = 0; i < indices.size(); ++i) std::memcpy(&indices[i], values.data() + i * stride, stride);
  return indices;
}

}  // namespace

std::optional<std::string> compressedStream(const GltfCompression& like, std::string_view values) {
  const uint64_t stride = like.byte_stride;
  const size_t count = values.size() / stride;
  std::string stream;
  const auto bytes = [&] { return reinterpret_cast<unsigned char*>(stream.data()); };
  if (like.mode == GltfCompression::Mode::kAttributes) {
    meshopt_encodeVertexVersion(0);
    stream.resize(meshopt_encodeVertexBufferBound(count, stride));
    stream.resize(meshopt_encodeVertexBuffer(bytes(), stream.size(), values.data(), count, stride));
    return stream;
  }
  const bool triangles = like.mode == GltfCompression::Mode::kTriangles;
  const std::vector<unsigned> indices = indicesOf(values, stride);
  const size_t vertices = size_t(*std::max_element(indices.begin(), indices.end())) + 1;
  if (triangles && count % 3 != 0) return std::nullopt;
  meshopt_encodeIndexVersion(1);
  if (triangles) {
    stream.resize(meshopt_encodeIndexBufferBound(count, vertices));
    stream.resize(meshopt_encodeIndexBuffer(bytes(), stream.size(), indices.data(), count));
  } else {
    stream.resize(meshopt_encodeIndexSequenceBound(count, vertices));
    stream.resize(meshopt_encodeIndexSequence(bytes(), stream.size(), indices.data(), count));
  }
  return stream;
}

}  // namespace sightline
