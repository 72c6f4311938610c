// OBJ through tinyobjloader's callbacks. It reads lines, keywords and index triples; we give it the text a
// line at a time, so that a callback knows its line (for messages), and read the coordinates from that line
// ourselves: the library's own conversion is not correctly rounded, and takes "nan" or a missing coordinate
// for 0.
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <istream>
#include <sstream>
#include <streambuf>
#include <vector>

#include "core/error.h"
#include "core/scene/decimal.h"
#include "core/scene/loaders.h"
#include "core/scene/scene_builder.h"

namespace sightline {
namespace {

/// What some editors put before UTF-8 text.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// Serves a text line by line. Makes every line end a '\n', and in lines of vertices and faces joins those
/// continued by a backslash and blanks out comments.
class LineBuffer : public std::streambuf {
 public:
  explicit LineBuffer(const FileBytes& bytes)
      : begin_(bytes.data.get() + (bytes.view().starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0)),
        end_(bytes.data.get() + bytes.size),
        line_(begin_),
        next_(begin_) {}

  /// The line last served, without its end.
  std::string_view line() const {
    const size_t size = size_t(next_ - line_);
    return {line_, size != 0 && line_[size - 1] == '\n' ? size - 1 : size};
  }
  uint64_t lineNumber() const { return line_number_; }

 protected:
  int_type underflow() override {
    if (next_ == end_) return traits_type::eof();
    line_number_ += lines_in_line_;
    lines_in_line_ = 1;
    line_ = next_;
    next_ = endOfLine(line_);
    const size_t blanks =
        size_t(std::find_if(line_, next_, [](char c) { return c != ' ' && c != '\t'; }) - line_);
    if (line_ + blanks != next_ && (line_[blanks] == 'v' || line_[blanks] == 'f')) cleanLine();
    setg(line_, line_, next_);
    return traits_type::to_int_type(*line_);
  }

 private:
  char* endOfLine(char* from) const {
    auto* newline = static_cast<char*>(std::memchr(from, '\n', size_t(end_ - from)));
    char* stop = newline == nullptr ? end_ : newline + 1;
    auto* carriage = static_cast<char*>(std::memchr(from, '\r', size_t(stop - from)));
    if (carriage == nullptr) return stop;
    if (carriage + 1 == newline) {
      *carriage = ' ';
      return stop;
    }
    *carriage = '\n';
    return carriage + 1;
  }

  void cleanLine() {
    while (next_ != end_) {
      char* last = next_ - 1;  // the '\n'; before it blanks, then perhaps the backslash
      char* mark = last;
      while (mark != line_ && (mark[-1] == ' ' || mark[-1] == '\t')) --mark;
      if (mark == line_ || mark[-1] != '\\') break;
      mark[-1] = ' ';
      *last = ' ';
      next_ = endOfLine(next_);
      ++lines_in_line_;
    }
    char* comment = std::find(line_, next_, '#');
    for (; comment != next_; ++comment) {
      if (*comment != '\n') *comment = ' ';
    }
  }

  char* begin_;
  char* end_;
  char* line_;  ///< start of the line last served
  char* next_;  ///< its end
  uint64_t line_number_ = 0;
  uint64_t lines_in_line_ = 1;  ///< how many of the file's lines it joins
};

/// Thrown to start again: a face uses a vertex that stands further down.
struct ForwardReference {};

class ObjReader {
 public:
  ObjReader(const FileBytes& bytes, const std::string& name, const SceneLoadOptions& options)
      : bytes_(bytes), name_(name), options_(options), builder_(options) {}

  Scene read() {
    try {
      parse(true, true);
    } catch (const ForwardReference&) {
      builder_ = SceneBuilder(options_);
      parse(true, false);
      all_vertices_known_ = true;
      parse(false, true);
    }
    return builder_.finish(name_);
  }

 private:
  static ObjReader& self(void* data) { return *static_cast<ObjReader*>(data); }

  void parse(bool vertices, bool faces) {
    LineBuffer lines(bytes_);
    lines_ = &lines;
    vertices_so_far_ = 0;
    add_vertices_ = vertices;
    object_.clear();
    group_.clear();
    if (faces) builder_.beginObject("", kUnnamed);
    std::istream stream(&lines);
    stream.exceptions(std::ios::badbit);  // lets what the stream buffer throws pass
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* data, float, float, float, float) { self(data).vertex(); };
    if (faces) {
      callback.index_cb = [](void* data, tinyobj::index_t* indices, int count) {
        self(data).face({indices, size_t(count)});
      };
      callback.object_cb = [](void* data, const char* text) { self(data).object(text); };
      callback.group_cb = [](void* data, const char** names, int count) { self(data).group(names, count); };
    }
    tinyobj::LoadObjWithCallback(stream, callback, this);
  }

  std::string place() const { return fmt::format("{}:{}", name_, lines_->lineNumber()); }

  void vertex() {
    ++vertices_so_far_;
    if (!add_vertices_) return;
    std::string_view line = lines_->line();
    line.remove_prefix(line.find('v') + 1);
    glm::vec3 position;
    glm::dvec3 full;
    for (int i = 0; i < 3; ++i) {
      const std::optional<Decimal> coordinate = takeDecimal(line);
      if (!coordinate) throw Error(fmt::format("{}: expected three numbers after \"v\"", place()));
      position[i] = coordinate->single;
      full[i] = coordinate->full;
    }
    builder_.addPosition(position, full, [this] { return place(); });
  }

  void face(std::span<const tinyobj::index_t> indices) {
    corners_.clear();
    if (hasHugeNumber(lines_->line())) {
      readHugeCorners();
    } else {
      for (const tinyobj::index_t& index : indices) addCorner(index.vertex_index);
    }
    const VertexRange vertices{0, int64_t(builder_.positionCount()), 1};
    builder_.addPolygon(corners_, vertices, [this] { return place(); });
  }

  /// `number` as in the file: from 1, or from the last vertex back for negative ones; 0 is bad.
  void addCorner(int64_t number) {
    const int64_t corner = number < 0 ? vertices_so_far_ + number : number - 1;
    if (corner >= vertices_so_far_ && !all_vertices_known_) throw ForwardReference();
    corners_.push_back(corner);
  }

  /// Reads the face from its line, as the library does, but with numbers of 64 bits.
  void readHugeCorners() {
    std::istringstream words(std::string(lines_->line()));
    std::string word;
    words >> word;  // the "f"
    while (words >> word) {
      int64_t number = 0;
      const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
      addCorner(result.ec == std::errc::result_out_of_range ? kBeyondAny : number);
    }
  }

  /// Whether a number has ten digits or more: the library would wrap it around.
  static bool hasHugeNumber(std::string_view line) {
    int digits = 0;
    for (const char c : line) {
      digits = c >= '0' && c <= '9' ? digits + 1 : 0;
      if (digits >= 10) return true;
    }
    return false;
  }

  void object(std::string_view name) {
    object_ = cleanName(name);
    group_.clear();
    beginObject();
  }

  void group(const char** names, int count) {
    group_.clear();
    for (int i = 0; i < count; ++i) group_.append(i == 0 ? "" : " ").append(names[i]);
    group_ = cleanName(group_);
    beginObject();
  }

  void beginObject() {
    const bool both = !object_.empty() && !group_.empty() && object_ != group_;
    builder_.beginObject(both ? object_ + "/" + group_ : (group_.empty() ? object_ : group_), kUnnamed);
  }

  static constexpr int64_t kBeyondAny = 1ll << 62;
  static constexpr const char* kUnnamed = "default";  // the format's own name for it

  const FileBytes& bytes_;
  const std::string& name_;
  const SceneLoadOptions& options_;
  SceneBuilder builder_;
  LineBuffer* lines_ = nullptr;
  int64_t vertices_so_far_ = 0;
  bool add_vertices_ = true;
  bool all_vertices_known_ = false;
  std::string object_;
  std::string group_;
  std::vector<int64_t> corners_;
};

}  // namespace

Scene loadObj(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options) {
  const std::string name = file.string();
  return ObjReader(bytes, name, options).read();
}

}  // namespace sightline
