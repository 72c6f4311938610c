// PLY, after Greg Turk, The PLY Polygon File Format, 1994. Read here, for want of a library: Debian 12 has no
// small PLY reader, CGAL's is GPL, and Assimp's keeps neither rows for messages nor memory for 20M triangles.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/formats/load_scene.h"
#include "core/formats/loaders.h"
#include "core/formats/ply_header.h"
#include "core/formats/scene_builder.h"
#include "core/io/decimal.h"

namespace sightline {
namespace {

/// Takes numbers off the rows, in text or binary.
class NumberReader {
 public:
  NumberReader(std::string_view bytes, PlyFormat format) : rest_(bytes), format_(format) {}

  size_t bytesLeft() const { return rest_.size(); }
  /// Whether nothing is left that could be a number; true after a binary number could not be read.
  bool atEnd() const { return isBinary() || rest_.find_first_not_of(kBlanks) == std::string_view::npos; }
  bool isBinary() const { return format_ != PlyFormat::kAscii; }

  /// A value of any type; nothing at the file's end or where no number stands.
  std::optional<Decimal> real(PlyType type) {
    const bool fraction = type == PlyType::kFloat32 || type == PlyType::kFloat64;
    if (fraction && !isBinary()) return takeDecimal(rest_);
    const auto value = type == PlyType::kFloat32   ? binary<float, double>()
                       : type == PlyType::kFloat64 ? binary<double, double>()
                                                   : asDouble(whole(type));
    return value ? std::optional(Decimal{float(*value), *value}) : std::nullopt;
  }

  /// A value of a whole type.
  std::optional<int64_t> whole(PlyType type) {
    if (!isBinary()) return decimalInteger();
    switch (type) {
      case PlyType::kInt8:
        return binary<int8_t, int64_t>();
      case PlyType::kUint8:
        return binary<uint8_t, int64_t>();
      case PlyType::kInt16:
        return binary<int16_t, int64_t>();
      case PlyType::kUint16:
        return binary<uint16_t, int64_t>();
      case PlyType::kInt32:
        return binary<int32_t, int64_t>();
      default:
        return binary<uint32_t, int64_t>();
    }
  }

 private:
  static std::optional<double> asDouble(std::optional<int64_t> value) {
    return value ? std::optional(double(*value)) : std::nullopt;
  }

  template <typename Stored, typename Result>
  std::optional<Result> binary() {
    if (rest_.size() < sizeof(Stored)) return std::nullopt;
    char bytes[sizeof(Stored)];
    std::memcpy(bytes, rest_.data(), sizeof(Stored));
    if (format_ == PlyFormat::kBigEndian) std::reverse(bytes, bytes + sizeof(Stored));
    rest_.remove_prefix(sizeof(Stored));
    return Result(std::bit_cast<Stored>(bytes));
  }

  std::optional<int64_t> decimalInteger() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    int64_t value = 0;
    const char* end = rest_.data() + rest_.size();
    const auto result = std::from_chars(rest_.data(), end, value);
    if (result.ec != std::errc()) return std::nullopt;
    if (result.ptr != end && kBlanks.find(*result.ptr) == std::string_view::npos) return std::nullopt;
    rest_.remove_prefix(size_t(result.ptr - rest_.data()));
    return value;
  }

  static constexpr std::string_view kBlanks = " \t\r\n\v\f";
  std::string_view rest_;
  PlyFormat format_;
};

/// Thrown to repair where rows of faces are missing at the file's end.
struct RowsEnd : std::exception {};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& name, const SceneLoadOptions& options,
            const glm::dvec3& offset)
      : name_(name),
        header_(readPlyHeader(bytes, name)),
        numbers_(bytes.substr(header_.data_offset), header_.format),
        builder_(options, offset) {
    if (options.cull_back_faces) builder_.beginSurface(kSurfaceFrontOnly);
  }

  Scene read(const std::string& object) {
    builder_.beginObject(object, "ply");
    std::vector<std::pair<const PlyElement*, NumberReader>>
        early;  // faces before the vertices, and their rows
    bool has_vertices = false;
    for (const PlyElement& element : header_.elements) {
      if (ended_) break;
      element_ = &element;
      const bool faces = element.name == "face" || element.name == "tristrips";
      if (element.name == "vertex" && !has_vertices) {
        has_vertices = true;
        readVertices();
        readEarly(early);
      } else if (faces && has_vertices) {
        readFaces();
      } else {
        if (faces) early.emplace_back(&element, numbers_);
        skipElement();
      }
    }
    if (!has_vertices && !early.empty()) throw Error(fmt::format("{}: has faces, but no vertices", name_));
    return builder_.finish(name_);
  }

 private:
  void readEarly(const std::vector<std::pair<const PlyElement*, NumberReader>>& early) {
    const NumberReader behind = numbers_;
    for (const auto& [element, rows] : early) {
      element_ = element;
      numbers_ = rows;
      readFaces();
    }
    numbers_ = behind;
  }

  std::string place() const { return fmt::format("{}: element {}, row {}", name_, element_->name, row_); }

  bool isFace() const { return element_->name == "face"; }

  [[noreturn]] void failAt(const PlyProperty& property) const {
    if (numbers_.atEnd() && may_end_) throw RowsEnd();
    throw Error(fmt::format("{}: property {}: {}", place(), property.name,
                            !numbers_.atEnd() ? "expected a number"
                            : !isFace()       ? "the file ends here; is it truncated?"
                                              : "the file ends here; is it truncated? --repair keeps the "
                                                "faces before"));
  }

  /// How many rows could still come, so that memory follows the file's size and not its claims.
  uint64_t possibleRows() const {
    const uint64_t least = std::max<uint64_t>(1, element_->leastRowBytes(header_.format));
    return std::min<uint64_t>(element_->count, (numbers_.bytesLeft() + 1) / least);
  }

  void readVertices() {
    size_t where[3];
    for (int i = 0; i < 3; ++i) {
      const char* axis = i == 0 ? "x" : (i == 1 ? "y" : "z");
      const std::optional<size_t> found = element_->find(axis);
      if (!found || element_->properties[*found].list_size_type) {
        throw Error(fmt::format("{}: element vertex has no property {}", name_, axis));
      }
      where[i] = *found;
    }
    builder_.reserve(possibleRows(), 0);
    for (row_ = 0; row_ < element_->count; ++row_) {
      glm::vec3 position;
      glm::dvec3 full;
      for (size_t i = 0; i < element_->properties.size(); ++i) {
        const Decimal value = skipOrRead(element_->properties[i]);
        for (int axis = 0; axis < 3; ++axis) {
          if (where[axis] != i) continue;
          position[axis] = value.single;
          full[axis] = value.full;
        }
      }
      builder_.addPosition(position, full, [this] { return place(); });
    }
  }

  void readFaces() {
    const bool strips = element_->name == "tristrips";
    std::optional<size_t> list = element_->find("vertex_indices");
    if (!list) list = element_->find("vertex_index");
    if (!list || !element_->properties[*list].list_size_type) {
      throw Error(fmt::format("{}: element {} has no list vertex_indices", name_, element_->name));
    }
    const PlyType type = element_->properties[*list].type;
    if (type == PlyType::kFloat32 || type == PlyType::kFloat64) {
      throw Error(fmt::format("{}: element {}: vertex indices need a whole type", name_, element_->name));
    }
    if (!strips) builder_.reserve(0, possibleRows());
    for (row_ = 0; row_ < element_->count; ++row_) {
      if (!readFace(*list)) return;
      const VertexRange vertices{0, int64_t(builder_.positionCount()), 0};
      if (strips) {
        addStrips(vertices);
      } else {
        builder_.nextFace();
        builder_.addPolygon(corners_, vertices, [this] { return place(); });
      }
    }
  }

  /// Reads the corners of a row, whose list they are; false, to repair, where the file ends.
  bool readFace(size_t list) {
    may_end_ = isFace() && builder_.repairs();
    try {
      for (size_t i = 0; i < element_->properties.size(); ++i) {
        if (i == list) {
          readCorners(element_->properties[i]);
        } else {
          skipOrRead(element_->properties[i]);
        }
      }
      may_end_ = false;
      return true;
    } catch (const RowsEnd&) {
      ended_ = true;
      builder_.warn(
          fmt::format("the header promises {} faces, the file ends after {}", element_->count, row_));
      return false;
    }
  }

  /// Strips in one list, -1 between them.
  void addStrips(const VertexRange& vertices) {
    size_t start = 0;
    for (size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i] == -1) {
        start = i + 1;
      } else if (i >= start + 2) {
        const bool turned = (i - start) % 2 != 0;
        const int64_t triangle[3] = {corners_[turned ? i - 1 : i - 2], corners_[turned ? i - 2 : i - 1],
                                     corners_[i]};
        builder_.nextFace();
        builder_.addPolygon(triangle, vertices, [this] { return place(); });
      }
    }
  }

  uint64_t readListSize(const PlyProperty& property) {
    const std::optional<int64_t> size = numbers_.whole(*property.list_size_type);
    if (!size) failAt(property);
    const uint64_t item_bytes = numbers_.isBinary() ? plyTypeBytes(property.type) : 2;
    if (*size < 0 || uint64_t(*size) > (numbers_.bytesLeft() + 1) / item_bytes) {
      if (may_end_) throw RowsEnd();
      throw Error(fmt::format("{}: property {}: a list of {} values does not fit the {} bytes left", place(),
                              property.name, *size, numbers_.bytesLeft()));
    }
    return uint64_t(*size);
  }

  void readCorners(const PlyProperty& property) {
    corners_.clear();
    const uint64_t size = readListSize(property);
    for (uint64_t i = 0; i < size; ++i) {
      const std::optional<int64_t> corner = numbers_.whole(property.type);
      if (!corner) failAt(property);
      corners_.push_back(*corner);
    }
  }

  /// The value of a plain property; reads over a list.
  Decimal skipOrRead(const PlyProperty& property) {
    const uint64_t values = property.list_size_type ? readListSize(property) : 1;
    Decimal last;
    for (uint64_t i = 0; i < values; ++i) {
      const std::optional<Decimal> value = numbers_.real(property.type);
      if (!value) failAt(property);
      last = *value;
    }
    return last;
  }

  void skipElement() {
    if (element_->properties.empty()) return;
    for (row_ = 0; row_ < element_->count; ++row_) {
      for (const PlyProperty& property : element_->properties) skipOrRead(property);
    }
  }

  const std::string& name_;
  PlyHeader header_;
  NumberReader numbers_;
  SceneBuilder builder_;
  const PlyElement* element_ = nullptr;
  uint64_t row_ = 0;
  bool may_end_ = false;  ///< rows may be missing: faces are read, to repair
  bool ended_ = false;    ///< they were
  std::vector<int64_t> corners_;
};

}  // namespace

Scene loadPly(std::string_view bytes, const std::filesystem::path& file, const SceneLoadOptions& options,
              const glm::dvec3& offset) {
  const std::string name = file.string();
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
  return PlyReader(bytes, name, options, offset).read(file.stem().string());
}

}  // namespace sightline
