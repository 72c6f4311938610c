// Based on: Google, Draco Bitstream Specification, version 2.2, 2017; the decoder is libdraco's. It trusts
// the counts that a stream begins with and makes room for them, so those are read and checked here before.
#include "core/formats/draco_stream.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <cstring>

#include "core/base/error.h"

namespace sightline {
namespace {

/// Triangles and points that a byte of a stream may stand for: those of a flat, regular grid take a fraction
/// of a bit each.
constexpr uint64_t kMostAByte = 512;

class StreamReader {
 public:
  StreamReader(std::span<const uint8_t> stream, const DracoWish& wish, const std::string& place)
      : stream_(stream), wish_(wish), place_(place) {}

  DracoData read() {
    checkCounts();
    draco::DecoderBuffer buffer = wholeBuffer();
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) damaged(decoded.status().error_msg());
    mesh_ = std::move(decoded).value();
    DracoData data;
    data.points = mesh_->num_points();
    data.corners = 3 * uint64_t(mesh_->num_faces());
    for (const DracoWish::Attribute& attribute : wish_.attributes) {
      data.attributes.push_back(valuesOf(attribute));
    }
    data.corner_points = cornerPoints();
    return data;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}: {}", place_, what)); }
  [[noreturn]] void damaged(const std::string& why) const {
    fail(fmt::format("the Draco stream is cut off or damaged ({}); export the file again", why));
  }

  draco::DecoderBuffer wholeBuffer() const {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream_.data()), stream_.size());
    return buffer;
  }

  /// Reads as far as the numbers of triangles and points stand.
  void checkCounts() const {
    draco::DecoderBuffer buffer = wholeBuffer();
    draco::DracoHeader header;
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) damaged("no header");
    if (header.encoder_type != draco::TRIANGULAR_MESH) fail("the Draco stream holds points, not a mesh");
    if (header.version_major != 2 || header.version_minor != 2) {
      fail(fmt::format("Draco bitstream version {}.{}, glTF has 2.2; export the file again",
                       header.version_major, header.version_minor));
    }
    buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
    if ((header.flags & METADATA_FLAG_MASK) != 0) {
      draco::GeometryMetadata metadata;
      if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) damaged("bad metadata");
    }
    uint32_t faces = 0, points = 0;
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
      if (!draco::DecodeVarint(&faces, &buffer) || !draco::DecodeVarint(&points, &buffer))
        damaged("no counts");
    } else {
      uint8_t traversal = 0;  // points are those of the surface: attributes may split them
      if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&points, &buffer) ||
          !draco::DecodeVarint(&faces, &buffer)) {
        damaged("no counts");
      }
    }
    const uint64_t most = kMostAByte * stream_.size();
    if (points <= most && faces <= most) return;
    damaged(fmt::format("it claims {} points and {} triangles in {} bytes", points, faces, stream_.size()));
  }

  template <typename T>
  std::vector<uint8_t> valuesAs(const draco::PointAttribute& attribute, uint32_t width) const {
    std::vector<uint8_t> bytes(size_t(mesh_->num_points()) * width * sizeof(T));
    std::vector<T> value(width);
    uint8_t* to = bytes.data();
    for (uint32_t point = 0; point < mesh_->num_points(); ++point) {
      const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(point));
      if (index.value() >= attribute.size()) damaged("a value out of range");
      if (!attribute.ConvertValue<T>(index, int8_t(width), value.data())) damaged("values of another type");
      std::memcpy(to, value.data(), width * sizeof(T));
      to += width * sizeof(T);
    }
    return bytes;
  }

  std::vector<uint8_t> valuesOf(const DracoWish::Attribute& wish) const {
    const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(wish.number);
    if (attribute == nullptr) {
      fail(fmt::format("the Draco stream has no attribute of the number {}; export the file again",
                       wish.number));
    }
    if (attribute->num_components() != wish.width) {
      fail(fmt::format("the Draco stream's attribute {} has {} components, its accessor {}", wish.number,
                       attribute->num_components(), wish.width));
    }
    switch (wish.component) {
      case GltfComponent::kByte:
        return valuesAs<int8_t>(*attribute, wish.width);
      case GltfComponent::kUnsignedByte:
        return valuesAs<uint8_t>(*attribute, wish.width);
      case GltfComponent::kShort:
        return valuesAs<int16_t>(*attribute, wish.width);
      case GltfComponent::kUnsignedShort:
        return valuesAs<uint16_t>(*attribute, wish.width);
      case GltfComponent::kUnsignedInt:
        return valuesAs<uint32_t>(*attribute, wish.width);
      case GltfComponent::kFloat:
        return valuesAs<float>(*attribute, wish.width);
    }
    return {};
  }

  template <typename T>
  std::vector<uint8_t> cornersAs() const {
    std::vector<uint8_t> bytes(3 * size_t(mesh_->num_faces()) * sizeof(T));
    uint8_t* to = bytes.data();
    for (uint32_t face = 0; face < mesh_->num_faces(); ++face) {
      for (const draco::PointIndex& point : mesh_->face(draco::FaceIndex(face))) {
        const T corner = T(point.value());
        if (point.value() >= mesh_->num_points()) damaged("a corner out of range");
        if (corner != point.value()) fail("the indices' componentType is too small for the points");
        std::memcpy(to, &corner, sizeof(T));
        to += sizeof(T);
      }
    }
    return bytes;
  }

  std::vector<uint8_t> cornerPoints() const {
    if (wish_.corner_component == GltfComponent::kUnsignedByte) return cornersAs<uint8_t>();
    if (wish_.corner_component == GltfComponent::kUnsignedShort) return cornersAs<uint16_t>();
    return cornersAs<uint32_t>();
  }

  std::span<const uint8_t> stream_;
  const DracoWish& wish_;
  const std::string& place_;
  std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace

DracoData decodeDraco(std::span<const uint8_t> stream, const DracoWish& wish, const std::string& place) {
  return StreamReader(stream, wish, place).read();
}

}  // namespace sightline
