#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

#include "core/base/error.h"
#include "core/formats/ply_header.h"
#include "core/strip/strip_formats.h"

namespace sightline {
namespace {

constexpr std::string_view kPlyBlanks = " \t\r\n\v\f";

/// A value of a row: where it stands and, of whole types, what it is.
struct PlyField {
  std::string_view bytes;
  int64_t value = 0;
};

/// Values of rows, one after the other. The loader has read the file, so all are there.
class PlyFields {
 public:
  PlyFields(std::string_view bytes, PlyFormat format) : rest_(bytes), format_(format) {}

  const char* at() const { return rest_.data(); }

  PlyField next(PlyType type) {
    if (format_ == PlyFormat::kAscii) return nextWord();
    const size_t size = plyTypeBytes(type);
    if (size > rest_.size()) throw Error("a row of the PLY file ends too early");
    const PlyField field{rest_.substr(0, size), wholeOf(rest_.substr(0, size), type)};
    rest_.remove_prefix(size);
    return field;
  }

  /// In text, what is left of the row's line.
  void endRow() {
    if (format_ != PlyFormat::kAscii) return;
    const size_t end = rest_.find_first_not_of(" \t\v\f");
    if (end == std::string_view::npos) return;
    if (rest_[end] != '\r' && rest_[end] != '\n') return;  // the next row stands in the same line
    rest_.remove_prefix(end);
    rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : 1);
  }

 private:
  PlyField nextWord() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kPlyBlanks), rest_.size()));
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kPlyBlanks));
    if (word.empty()) throw Error("a row of the PLY file ends too early");
    rest_.remove_prefix(word.size());
    PlyField field{word, 0};
    std::from_chars(word.data(), word.data() + word.size(), field.value);
    return field;
  }

  template <typename T>
  int64_t valueOf(std::string_view bytes) const {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes.data(), sizeof(T));
    if (format_ == PlyFormat::kBigEndian) std::reverse(raw, raw + sizeof(T));
    return int64_t(std::bit_cast<T>(raw));
  }

  int64_t wholeOf(std::string_view bytes, PlyType type) const {
    switch (type) {
      case PlyType::kInt8:
        return valueOf<int8_t>(bytes);
      case PlyType::kUint8:
        return valueOf<uint8_t>(bytes);
      case PlyType::kInt16:
        return valueOf<int16_t>(bytes);
      case PlyType::kUint16:
        return valueOf<uint16_t>(bytes);
      case PlyType::kInt32:
        return valueOf<int32_t>(bytes);
      case PlyType::kUint32:
        return valueOf<uint32_t>(bytes);
      default:
        return 0;
    }
  }

  std::string_view rest_;
  PlyFormat format_;
};

/// A row in the file, and its list of vertices.
struct PlyRow {
  const char* begin = nullptr;
  const char* end = nullptr;
  PlyField size;  ///< of the list
  std::vector<PlyField> corners;
};

class PlyStripper {
 public:
  explicit PlyStripper(const StripInput& input)
      : input_(input), mark_(input.bytes.starts_with("\xef\xbb\xbf") ? 3 : 0) {
    bytes_ = input.bytes.substr(mark_);
    header_ = readPlyHeader(bytes_, input.file.string());
    kept_ = keptFaces(input, stripped_.report);
  }

  Stripped run() {
    compact_ = input_.options.compact && canCompact();
    if (compact_) {
      markUsed();
      number();
    }
    std::vector<uint64_t> counts;
    const std::string rows = writeRows(counts);
    std::string text(input_.bytes.substr(0, mark_));
    writeHeader(counts, text);
    text += rows;
    stripped_.report.bytes_before = input_.bytes.size();
    stripped_.report.bytes = text.size();
    stripped_.files.push_back({input_.out, std::move(text)});
    return std::move(stripped_);
  }

 private:
  static bool isStrips(const PlyElement& element) { return element.name == "tristrips"; }
  static bool isFaces(const PlyElement& element) { return element.name == "face" || isStrips(element); }

  /// Other elements may number vertices: edges do.
  bool canCompact() {
    for (const PlyElement& element : header_.elements) {
      if (isFaces(element) || element.name == "vertex" || element.count == 0) continue;
      stripped_.report.notes.push_back(
          fmt::format("vertices all stay: element {} may number them", element.name));
      return false;
    }
    return true;
  }

  static const PlyProperty* cornersOf(const PlyElement& element) {
    std::optional<size_t> list = element.find("vertex_indices");
    if (!list) list = element.find("vertex_index");
    return isFaces(element) && list ? &element.properties[*list] : nullptr;
  }

  /// Calls visit(element's number, row's number, row) for each row, in order. Returns where the last one
  /// ends.
  template <typename Visit>
  const char* walk(const Visit& visit) {
    PlyFields fields(bytes_.substr(header_.data_offset), header_.format);
    PlyRow row;
    for (size_t e = 0; e < header_.elements.size(); ++e) {
      const PlyElement& element = header_.elements[e];
      if (element.properties.empty()) continue;
      const PlyProperty* corners = cornersOf(element);
      for (uint64_t r = 0; r < element.count; ++r) {
        row.begin = fields.at();
        row.corners.clear();
        for (const PlyProperty& property : element.properties) {
          readProperty(fields, property, &property == corners ? &row : nullptr);
        }
        fields.endRow();
        row.end = fields.at();
        visit(e, r, row);
      }
    }
    return fields.at();
  }

  static void readProperty(PlyFields& fields, const PlyProperty& property, PlyRow* row) {
    int64_t values = 1;
    if (property.list_size_type) {
      const PlyField size = fields.next(*property.list_size_type);
      if (row != nullptr) row->size = size;
      values = size.value;
    }
    for (int64_t i = 0; i < values; ++i) {
      const PlyField field = fields.next(property.type);
      if (row != nullptr) row->corners.push_back(field);
    }
  }

  bool keeps(size_t face) const { return face < kept_.size() && kept_[face]; }

  /// The list of a row of strips without what goes: each triangle that stays as a strip of its own. Nothing
  /// if all stay. `face` is the number of the row's first triangle, and becomes that of the next row's.
  std::optional<std::vector<int64_t>> strippedStrips(const PlyRow& row, size_t& face) const {
    std::vector<int64_t> list;
    bool all = true;
    size_t start = 0;
    for (size_t i = 0; i < row.corners.size(); ++i) {
      if (row.corners[i].value == -1) {
        start = i + 1;
        continue;
      }
      if (i < start + 2) continue;
      if (!keeps(face++)) {
        all = false;
        continue;
      }
      const bool turned = (i - start) % 2 != 0;
      if (!list.empty()) list.push_back(-1);
      for (const size_t corner : {turned ? i - 1 : i - 2, turned ? i - 2 : i - 1, i}) {
        list.push_back(row.corners[corner].value);
      }
    }
    return all ? std::nullopt : std::optional(list);
  }

  void use(int64_t vertex) {
    if (vertex < 0) return;
    if (size_t(vertex) >= used_.size()) used_.resize(size_t(vertex) + 1, false);
    used_[size_t(vertex)] = true;
  }

  void markUsed() {
    size_t face = 0;
    walk([&](size_t e, uint64_t, const PlyRow& row) {
      const PlyElement& element = header_.elements[e];
      if (!isFaces(element)) return;
      if (isStrips(element)) {
        if (const auto list = strippedStrips(row, face)) {
          for (const int64_t corner : *list) use(corner);
          return;
        }
      } else if (!keeps(face++)) {
        return;
      }
      for (const PlyField& corner : row.corners) use(corner.value);
    });
  }

  void number() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") used_.resize(std::max<size_t>(used_.size(), element.count), false);
    }
    uint64_t next = 0;
    for (const bool used : used_) {
      new_number_.push_back(int64_t(next));
      next += used ? 1 : 0;
    }
  }

  int64_t renumbered(int64_t vertex) const {
    return compact_ && vertex >= 0 ? new_number_[size_t(vertex)] : vertex;
  }

  /// The rows that stay; counts: of each element.
  std::string writeRows(std::vector<uint64_t>& counts) {
    counts.assign(header_.elements.size(), 0);
    for (size_t e = 0; e < counts.size(); ++e) {
      if (header_.elements[e].properties.empty()) counts[e] = header_.elements[e].count;
    }
    std::string rows;
    rows.reserve(bytes_.size());
    size_t face = 0;
    const char* end = walk([&](size_t e, uint64_t r, const PlyRow& row) {
      const PlyElement& element = header_.elements[e];
      if (isStrips(element)) {
        writeStrips(element, row, face, rows);
      } else if (element.name == "face") {
        if (!keeps(face++)) return;
        writeFace(element, row, rows);
      } else if (element.name == "vertex" && compact_ && !used_[r]) {
        return;
      } else {
        rows.append(row.begin, row.end);
      }
      ++counts[e];
    });
    rows.append(end, bytes_.data() + bytes_.size());
    return rows;
  }

  void writeFace(const PlyElement& element, const PlyRow& row, std::string& rows) const {
    if (!compact_) {
      rows.append(row.begin, row.end);
      return;
    }
    const PlyType type = cornersOf(element)->type;
    const char* copied = row.begin;
    for (const PlyField& corner : row.corners) {
      rows.append(copied, corner.bytes.data());
      writeWhole(renumbered(corner.value), type, rows);
      copied = corner.bytes.data() + corner.bytes.size();
    }
    rows.append(copied, row.end);
  }

  void writeStrips(const PlyElement& element, const PlyRow& row, size_t& face, std::string& rows) const {
    std::optional<std::vector<int64_t>> list = strippedStrips(row, face);
    if (!list && !compact_) {
      rows.append(row.begin, row.end);
      return;
    }
    if (!list) {
      list.emplace();
      for (const PlyField& corner : row.corners) list->push_back(corner.value);
    }
    const PlyProperty& property = *cornersOf(element);
    const bool text = header_.format == PlyFormat::kAscii;
    rows.append(row.begin, row.size.bytes.data());
    writeWhole(int64_t(list->size()), *property.list_size_type, rows);
    for (const int64_t corner : *list) {
      if (text) rows += ' ';
      writeWhole(renumbered(corner), property.type, rows);
    }
    const PlyField& last = row.corners.empty() ? row.size : row.corners.back();
    rows.append(last.bytes.data() + last.bytes.size(), row.end);
  }

  void writeWhole(int64_t value, PlyType type, std::string& rows) const {
    if (header_.format == PlyFormat::kAscii) {
      rows += fmt::format("{}", value);
      return;
    }
    const size_t size = plyTypeBytes(type);
    const bool has_sign = type == PlyType::kInt8 || type == PlyType::kInt16 || type == PlyType::kInt32;
    if (value >= int64_t(1) << (8 * size - (has_sign ? 1 : 0))) {
      throw Error(fmt::format("{}: {} does not fit a list of this type; write the strips as faces",
                              input_.file.string(), value));
    }
    char raw[8];
    std::memcpy(raw, &value, sizeof(value));
    if (header_.format == PlyFormat::kBigEndian) std::reverse(raw, raw + size);
    rows.append(raw, size);
  }

  /// The header with these counts in its element lines.
  void writeHeader(const std::vector<uint64_t>& counts, std::string& text) const {
    std::string_view rest = bytes_.substr(0, header_.data_offset);
    size_t element = 0;
    while (!rest.empty()) {
      const size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
      const std::string_view line = rest.substr(0, end);
      const size_t keyword = line.find_first_not_of(" \t");
      if (keyword != std::string_view::npos && line.substr(keyword).starts_with("element") &&
          line.substr(keyword + 7).find_first_of(" \t") == 0) {
        const size_t digits = line.find_last_of("0123456789");
        const size_t first = line.find_last_of(" \t", digits) + 1;
        text.append(line.substr(0, first)).append(fmt::format("{}", counts[element++]));
        text.append(line.substr(digits + 1));
      } else {
        text.append(line);
      }
      const size_t next = std::min(rest.find_first_not_of("\r\n", end), rest.size());
      text.append(rest.substr(end, next - end));
      rest.remove_prefix(next);
    }
  }

  const StripInput& input_;
  size_t mark_;  ///< bytes of a byte order mark
  std::string_view bytes_;
  PlyHeader header_;
  Stripped stripped_;
  std::vector<bool> kept_;
  bool compact_ = false;
  std::vector<bool> used_;  ///< vertices
  std::vector<int64_t> new_number_;
};

}  // namespace

Stripped stripPly(const StripInput& input) {
  return PlyStripper(input).run();
}

}  // namespace sightline
