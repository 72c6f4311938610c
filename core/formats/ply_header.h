#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sightline {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;       ///< of the value, or of each value of the list
  std::optional<PlyType> list_size_type;  ///< set for lists
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;  ///< rows
  std::vector<PlyProperty> properties;

  /// Index of the property of that name, if there is one.
  std::optional<size_t> find(std::string_view property) const;
  /// Bytes that a row takes at least in that format: lists empty, numbers of one digit.
  uint64_t leastRowBytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t data_offset = 0;  ///< of the first row
};

uint64_t plyTypeBytes(PlyType type);

/// Reads the header, "ply" to "end_header". Lines end in "\n", "\r\n" or "\r". Throws Error with the line.
PlyHeader readPlyHeader(std::string_view bytes, const std::string& file);

}  // namespace sightline
