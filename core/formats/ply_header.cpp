#include "core/formats/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/base/error.h"

namespace sightline {
namespace {

/// Takes a line, without its end, off the text's start. Nothing if no line end is left.
std::optional<std::string_view> takeLine(std::string_view bytes, size_t& offset) {
  const size_t end = bytes.find_first_of("\r\n", offset);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = bytes.substr(offset, end - offset);
  offset = end + (bytes.substr(end, 2) == "\r\n" ? 2 : 1);
  return line;
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  size_t begin = line.find_first_not_of(" \t");
  while (begin != std::string_view::npos) {
    const size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(" \t", end);
  }
  return words;
}

std::optional<PlyType> typeOf(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{{"char", PlyType::kInt8},
                                                                            {"uchar", PlyType::kUint8},
                                                                            {"short", PlyType::kInt16},
                                                                            {"ushort", PlyType::kUint16},
                                                                            {"int", PlyType::kInt32},
                                                                            {"uint", PlyType::kUint32},
                                                                            {"float", PlyType::kFloat32},
                                                                            {"double", PlyType::kFloat64},
                                                                            {"int8", PlyType::kInt8},
                                                                            {"uint8", PlyType::kUint8},
                                                                            {"int16", PlyType::kInt16},
                                                                            {"uint16", PlyType::kUint16},
                                                                            {"int32", PlyType::kInt32},
                                                                            {"uint32", PlyType::kUint32},
                                                                            {"float32", PlyType::kFloat32},
                                                                            {"float64", PlyType::kFloat64}}};
  for (const auto& [known, type] : kTypes) {
    if (name == known) return type;
  }
  return std::nullopt;
}

/// Reads the header line by line; `fail` adds file and line.
class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  PlyHeader read() {
    if (nextLine() != std::vector<std::string_view>{"ply"}) fail("expected \"ply\"");
    const std::vector<std::string_view> format = nextLine();
    if (format.size() != 3 || format[0] != "format") fail("expected \"format\"");
    readFormat(format[1], format[2]);
    while (true) {
      const std::vector<std::string_view> words = nextLine();
      if (words.empty()) fail("empty line in the header");
      if (words[0] == "end_header") break;
      // "Created by Blender3D 247 ..." is a comment that its exporter forgot to mark.
      if (words[0] == "comment" || words[0] == "obj_info" || words[0] == "Created") continue;
      if (words[0] == "element") {
        readElement(words);
      } else if (words[0] == "property") {
        readProperty(words);
      } else {
        fail("expected comment, obj_info, element, property or end_header");
      }
    }
    header_.data_offset = offset_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}:{}: {}", file_, line_number_, what));
  }

  std::vector<std::string_view> nextLine() {
    ++line_number_;
    const std::optional<std::string_view> line = takeLine(bytes_, offset_);
    if (!line) fail("the header is cut off, \"end_header\" is missing");
    return wordsOf(*line);
  }

  void readFormat(std::string_view format, std::string_view version) {
    if (version != "1.0") fail("expected format version 1.0");
    if (format == "ascii") {
      header_.format = PlyFormat::kAscii;
    } else if (format == "binary_little_endian") {
      header_.format = PlyFormat::kLittleEndian;
    } else if (format == "binary_big_endian") {
      header_.format = PlyFormat::kBigEndian;
    } else {
      fail("expected format ascii, binary_little_endian or binary_big_endian");
    }
  }

  void readElement(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail("expected \"element NAME COUNT\"");
    PlyElement element;
    element.name = words[1];
    const char* end = words[2].data() + words[2].size();
    const auto result = std::from_chars(words[2].data(), end, element.count);
    if (result.ec != std::errc() || result.ptr != end) fail("expected a whole number of rows");
    header_.elements.push_back(std::move(element));
  }

  void readProperty(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("property before any element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (words.size() != 3 && !list)
      fail("expected \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
    const std::optional<PlyType> type = typeOf(words[words.size() - 2]);
    const std::optional<PlyType> size_type = list ? typeOf(words[2]) : std::nullopt;
    if (!type || (list && !size_type)) fail("unknown type");
    if (size_type == PlyType::kFloat32 || size_type == PlyType::kFloat64)
      fail("a list's size needs a whole type");
    PlyElement& element = header_.elements.back();
    if (element.find(words.back())) fail("the element has a property of that name");
    element.properties.push_back({std::string(words.back()), *type, size_type});
  }

  std::string_view bytes_;
  const std::string& file_;
  size_t offset_ = 0;
  uint64_t line_number_ = 0;
  PlyHeader header_;
};

}  // namespace

uint64_t plyTypeBytes(PlyType type) {
  constexpr uint64_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[size_t(type)];
}

std::optional<size_t> PlyElement::find(std::string_view property) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return std::nullopt;
}

uint64_t PlyElement::leastRowBytes(PlyFormat format) const {
  if (format == PlyFormat::kAscii) return 2 * properties.size();
  uint64_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += plyTypeBytes(property.list_size_type.value_or(property.type));
  }
  return bytes;
}

PlyHeader readPlyHeader(std::string_view bytes, const std::string& file) {
  return HeaderReader(bytes, file).read();
}

}  // namespace sightline
