#include "core/formats/gltf_data.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>

#include "core/base/error.h"
#include "core/io/base64.h"
#include "core/io/beside.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

/// meshoptimizer's codecs gain at most this much: a block of 256 vertices takes 4 bytes for each byte of the
/// vertex, a triangle at least 1 byte for its 12. Larger claims are refused before memory is taken.
constexpr uint64_t kMaxGain = 64;

std::span<const uint8_t> asBytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

std::vector<uint8_t> readDataUri(const std::string& uri, const std::string& place) {
  const size_t comma = uri.find(',');
  const std::string_view head = std::string_view(uri).substr(0, comma == std::string::npos ? 0 : comma);
  if (!head.ends_with(";base64")) throw Error(fmt::format("{}: expected data:...;base64,...", place));
  std::string_view text = std::string_view(uri).substr(comma + 1);
  std::string joined;  // some writers break the lines
  if (text.find_first_of(" \t\r\n") != std::string_view::npos) {
    for (const char c : text) {
      if (c != ' ' && c != '\t' && c != '\r' && c != '\n') joined += c;
    }
    text = joined;
  }
  std::optional<std::vector<uint8_t>> bytes = decodeBase64(text);
  if (!bytes) throw Error(fmt::format("{}: bad base64", place));
  return std::move(*bytes);
}

std::vector<uint8_t> readBesides(const std::string& uri, const std::filesystem::path& file,
                                 bool allow_external, const std::string& place) {
  const size_t colon = uri.find(':');
  if (colon != std::string::npos && colon < uri.find('/')) {
    throw Error(fmt::format("{}: only data: and files beside the scene are supported", place));
  }
  std::string name = percentDecoded(uri);
  const auto isControl = [](char c) { return static_cast<unsigned char>(c) < 0x20; };
  if (name.empty() || std::any_of(name.begin(), name.end(), isControl))
    throw Error(fmt::format("{}: bad file name", place));
  auto beside = besideScene(file, name, allow_external);
  std::error_code ignored;
  if (beside && name != uri && !std::filesystem::exists(*beside, ignored)) {
    const auto raw = besideScene(file, uri, allow_external);  // some writers do not encode names
    if (raw && std::filesystem::exists(*raw, ignored)) beside = raw;
  }
  if (!beside) {
    throw Error(
        fmt::format("{}: lies outside of the scene's folder, where nothing is read; put it beside the scene, "
                    "or load it with --allow-external",
                    place));
  }
  try {
    const FileBytes bytes = readFile(*beside);
    const std::span<const uint8_t> data = asBytes(bytes.view());
    return {data.begin(), data.end()};
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", place, error.what()));
  }
}

}  // namespace

std::string percentDecoded(const std::string& uri) {
  const auto digit = [&](size_t i) -> int {
    const char c = i < uri.size() ? uri[i] : '\0';
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  std::string result;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%' || digit(i + 1) < 0 || digit(i + 2) < 0) {
      result += uri[i];
      continue;
    }
    result += char(digit(i + 1) * 16 + digit(i + 2));
    i += 2;
  }
  return result;
}

uint64_t gltfComponentBytes(GltfComponent component) {
  if (component == GltfComponent::kByte || component == GltfComponent::kUnsignedByte) return 1;
  if (component == GltfComponent::kShort || component == GltfComponent::kUnsignedShort) return 2;
  return 4;
}

GltfData::GltfData(const GltfDocument& document, std::string_view bin, const std::filesystem::path& file,
                   bool allow_external)
    : document_(document),
      bin_(asBytes(bin)),
      file_(file),
      allow_external_(allow_external),
      buffers_(document.buffers.size()),
      views_(document.views.size()) {}

std::span<const uint8_t> GltfData::buffer(size_t index) {
  Bytes& bytes = buffers_[index];
  if (bytes.loaded) return bytes.data;
  const GltfBuffer& buffer = document_.buffers[index];
  const std::string place = fmt::format("{}: buffers[{}].uri", file_.string(), index);
  if (!buffer.uri) {
    if (index != 0 || bin_.data() == nullptr) throw Error(fmt::format("{}: is missing", place));
    bytes.data = bin_;
  } else {
    bytes.own = resource(*buffer.uri, place);
    bytes.data = bytes.own;
  }
  bytes.data = bytes.data.first(std::min<uint64_t>(bytes.data.size(), buffer.byte_length));
  bytes.loaded = true;
  return bytes.data;
}

std::vector<uint8_t> GltfData::resource(const std::string& uri, const std::string& place) const {
  return uri.starts_with("data:") ? readDataUri(uri, place) : readBesides(uri, file_, allow_external_, place);
}

uint64_t GltfData::bytesOfUris() const {
  uint64_t bytes = 0;
  for (const Bytes& buffer : buffers_) bytes += buffer.own.size();
  return bytes;
}

std::span<const uint8_t> GltfData::part(size_t index, uint64_t offset, uint64_t length,
                                        const std::string& place) {
  const std::span<const uint8_t> bytes = buffer(index);
  const uint64_t claimed = document_.buffers[index].byte_length;
  if (bytes.size() < claimed && offset <= claimed && length <= claimed - offset &&
      (offset > bytes.size() || length > bytes.size() - offset)) {
    throw Error(fmt::format(
        "{}: bytes {} to {} + {} are missing: buffers[{}] has {} bytes, its byteLength says {}; is "
        "the file truncated?",
        place, offset, offset, length, index, bytes.size(), claimed));
  }
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw Error(fmt::format("{}: bytes {} to {} + {} lie outside of buffers[{}] with its {} bytes", place,
                            offset, offset, length, index, bytes.size()));
  }
  return bytes.subspan(offset, length);
}

std::span<const uint8_t> GltfData::view(size_t index) {
  Bytes& bytes = views_[index];
  if (bytes.loaded) return bytes.data;
  const GltfBufferView& view = document_.views[index];
  const std::string place = fmt::format("{}: bufferViews[{}]", file_.string(), index);
  if (view.compression) {
    bytes.own =
        decompress(*view.compression, view.byte_length, place + ".extensions." + view.compression->extension);
    bytes.data = bytes.own;
  } else {
    bytes.data = part(view.buffer, view.byte_offset, view.byte_length, place);
  }
  bytes.loaded = true;
  return bytes.data;
}

size_t GltfData::addView(GltfDocument& document, std::vector<uint8_t> bytes) {
  GltfBufferView described;
  described.byte_length = bytes.size();
  document.views.push_back(described);
  Bytes& view = views_.emplace_back();
  view.own = std::move(bytes);
  view.data = view.own;
  view.loaded = true;
  return views_.size() - 1;
}

std::vector<uint8_t> GltfData::decompress(const GltfCompression& c, uint64_t byte_length,
                                          const std::string& place) {
  using Mode = GltfCompression::Mode;
  using Filter = GltfCompression::Filter;
  const std::span<const uint8_t> packed = part(c.buffer, c.byte_offset, c.byte_length, place);
  const bool attributes = c.mode == Mode::kAttributes;
  // A stream's first byte: its kind, and the version in the lower half.
  const int first = packed.empty() ? 0 : packed[0];
  const int newest = attributes ? 0xa0 : (c.mode == Mode::kTriangles ? 0xe1 : 0xd1);
  if ((first & 0xf0) == (newest & 0xf0) && first > newest) {
    throw Error(
        fmt::format("{}: version {} of meshoptimizer's {} streams is not read, only up to {}; compress "
                    "the file for EXT_meshopt_compression, or not at all",
                    place, first & 0x0f, attributes ? "vertex" : "index", newest & 0x0f));
  }
  if (c.filter == Filter::kColor) throw Error(fmt::format("{}.filter: COLOR holds no positions", place));
  const bool stride_fits = attributes ? c.byte_stride % 4 == 0 && c.byte_stride >= 4 && c.byte_stride <= 256
                                      : c.byte_stride == 2 || c.byte_stride == 4;
  const bool filter_fits = (c.filter != Filter::kOctahedral || c.byte_stride == 4 || c.byte_stride == 8) &&
                           (c.filter != Filter::kQuaternion || c.byte_stride == 8);
  if (!stride_fits || !filter_fits) {
    throw Error(fmt::format("{}.byteStride: {} does not fit mode and filter", place, c.byte_stride));
  }
  if (c.count > packed.size() * kMaxGain || c.count * c.byte_stride > packed.size() * kMaxGain ||
      c.count * c.byte_stride > byte_length || (c.mode == Mode::kTriangles && c.count % 3 != 0)) {
    throw Error(fmt::format("{}.count: {} does not fit the data", place, c.count));
  }
  std::vector<uint8_t> bytes(c.count * c.byte_stride);
  if (bytes.empty()) return bytes;
  int failed = 0;
  switch (c.mode) {
    case Mode::kAttributes:
      failed = meshopt_decodeVertexBuffer(bytes.data(), c.count, c.byte_stride, packed.data(), packed.size());
      break;
    case Mode::kTriangles:
      failed = meshopt_decodeIndexBuffer(bytes.data(), c.count, c.byte_stride, packed.data(), packed.size());
      break;
    case Mode::kIndices:
      failed =
          meshopt_decodeIndexSequence(bytes.data(), c.count, c.byte_stride, packed.data(), packed.size());
      break;
  }
  if (failed != 0) throw Error(fmt::format("{}: the compressed data is damaged", place));
  if (c.filter == Filter::kOctahedral) meshopt_decodeFilterOct(bytes.data(), c.count, c.byte_stride);
  if (c.filter == Filter::kQuaternion) meshopt_decodeFilterQuat(bytes.data(), c.count, c.byte_stride);
  if (c.filter == Filter::kExponential) meshopt_decodeFilterExp(bytes.data(), c.count, c.byte_stride);
  return bytes;
}

}  // namespace sightline
