#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/base/error.h"
#include "core/formats/gltf_data.h"

namespace sightline {
namespace {

/// Checks that `count` > 0 elements of `bytes`, `stride` apart, lie in the view from `offset` on.
void checkRange(uint64_t view_bytes, uint64_t offset, uint64_t count, uint64_t stride, uint64_t bytes,
                const std::string& place) {
  if (offset <= view_bytes && bytes <= view_bytes - offset &&
      (stride == 0 || count - 1 <= (view_bytes - offset - bytes) / stride)) {
    return;
  }
  throw Error(fmt::format("{}: {} elements from byte {} on lie outside of the buffer view with its {} bytes",
                          place, count, offset, view_bytes));
}

template <typename T>
T load(const uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

uint64_t loadIndex(GltfComponent component, const uint8_t* from) {
  if (component == GltfComponent::kUnsignedByte) return *from;
  if (component == GltfComponent::kUnsignedShort) return load<uint16_t>(from);
  return load<uint32_t>(from);
}

bool isIndexType(GltfComponent component) {
  return component == GltfComponent::kUnsignedByte || component == GltfComponent::kUnsignedShort ||
         component == GltfComponent::kUnsignedInt;
}

}  // namespace

GltfReader::GltfReader(const GltfDocument& document, GltfData& data, size_t accessor, const std::string& file)
    : accessor_(document.accessors[accessor]) {
  const std::string place = fmt::format("{}: accessors[{}]", file, accessor);
  element_bytes_ = gltfComponentBytes(accessor_.component) * accessor_.width;
  if (accessor_.view && accessor_.count != 0) {
    const std::span<const uint8_t> bytes = data.view(*accessor_.view);
    const uint64_t stride = document.views[*accessor_.view].byte_stride;
    stride_ = stride == 0 ? element_bytes_ : stride;
    if (stride_ < element_bytes_) {
      throw Error(
          fmt::format("{}: elements of {} bytes do not fit byteStride {}", place, element_bytes_, stride_));
    }
    checkRange(bytes.size(), accessor_.byte_offset, accessor_.count, stride_, element_bytes_, place);
    base_ = bytes.data() + accessor_.byte_offset;
  }
  if (!accessor_.sparse) return;
  const GltfSparse& sparse = *accessor_.sparse;
  if (!isIndexType(sparse.indices_component))
    throw Error(fmt::format("{}: bad type of sparse indices", place));
  const std::span<const uint8_t> indices = data.view(sparse.indices_view);
  const std::span<const uint8_t> values = data.view(sparse.values_view);
  const uint64_t index_bytes = gltfComponentBytes(sparse.indices_component);
  checkRange(indices.size(), sparse.indices_offset, sparse.count, index_bytes, index_bytes,
             place + ".sparse.indices");
  checkRange(values.size(), sparse.values_offset, sparse.count, element_bytes_, element_bytes_,
             place + ".sparse.values");
  sparse_values_ = values.data() + sparse.values_offset;
  for (uint64_t i = 0; i < sparse.count; ++i) {
    const uint64_t index =
        loadIndex(sparse.indices_component, indices.data() + sparse.indices_offset + i * index_bytes);
    if (index >= accessor_.count || (i != 0 && index <= sparse_indices_.back())) {
      throw Error(fmt::format("{}.sparse.indices: element {} is {}; they must ascend and stay below {}",
                              place, i, index, accessor_.count));
    }
    sparse_indices_.push_back(index);
  }
}

const uint8_t* GltfReader::element(uint64_t i) {
  while (next_sparse_ < sparse_indices_.size() && sparse_indices_[next_sparse_] < i) ++next_sparse_;
  if (next_sparse_ < sparse_indices_.size() && sparse_indices_[next_sparse_] == i) {
    return sparse_values_ + next_sparse_ * element_bytes_;
  }
  return base_ == nullptr ? nullptr : base_ + i * stride_;
}

double GltfReader::component(uint64_t i, uint32_t c) {
  const uint8_t* from = element(i);
  if (from == nullptr) return 0.0;
  from += c * gltfComponentBytes(accessor_.component);
  const bool normalized = accessor_.normalized;
  switch (accessor_.component) {
    case GltfComponent::kFloat:
      return load<float>(from);
    case GltfComponent::kByte:
      return normalized ? std::max(load<int8_t>(from) / 127.0, -1.0) : load<int8_t>(from);
    case GltfComponent::kUnsignedByte:
      return normalized ? load<uint8_t>(from) / 255.0 : load<uint8_t>(from);
    case GltfComponent::kShort:
      return normalized ? std::max(load<int16_t>(from) / 32767.0, -1.0) : load<int16_t>(from);
    case GltfComponent::kUnsignedShort:
      return normalized ? load<uint16_t>(from) / 65535.0 : load<uint16_t>(from);
    case GltfComponent::kUnsignedInt:
      return load<uint32_t>(from);
  }
  return 0.0;
}

uint64_t GltfReader::index(uint64_t i) {
  const uint8_t* from = element(i);
  return from == nullptr ? 0 : loadIndex(accessor_.component, from);
}

}  // namespace sightline
