// OBJ, after Wavefront's Advanced Visualizer manual, appendix B1. Read here rather than by a library:
// tinyobjloader, which Debian has, cuts numbers short without a word ("1,001" is 1 to it, "nan" 0), does not
// round coordinates correctly, and skips every statement that it does not know.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <exception>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/base/error.h"
#include "core/formats/load_scene.h"
#include "core/formats/loaders.h"
#include "core/formats/mtl_file.h"
#include "core/formats/obj_lines.h"
#include "core/formats/scene_builder.h"
#include "core/io/beside.h"
#include "core/io/decimal.h"

namespace sightline {
namespace {

/// Stands for numbers beyond 64 bits, and for what is no number.
constexpr int64_t kBeyondAny = 1ll << 62;

/// Takes a whole number, with or without a sign, off the text; nothing if none stands there.
std::optional<int64_t> takeWhole(std::string_view& text) {
  std::string_view digits = text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  int64_t number = 0;
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (result.ec == std::errc::invalid_argument) return std::nullopt;
  text = digits.substr(size_t(result.ptr - digits.data()));
  return result.ec == std::errc::result_out_of_range ? kBeyondAny : number;
}

/// The vertex's number in a corner of a face: 7, 7/1, 7//3 or 7/1/3. Nothing if that is not all that stands
/// there.
std::optional<int64_t> cornerNumber(std::string_view word) {
  const std::optional<int64_t> number = takeWhole(word);
  for (int field = 0; field < 2 && word.starts_with('/'); ++field) {
    word.remove_prefix(1);
    takeWhole(word);  // of a texture coordinate, then of a normal; may be missing
  }
  return word.empty() ? number : std::nullopt;
}

/// Statements that hold surfaces, but no polygons.
constexpr std::array<std::string_view, 4> kFreeForm = {"surf", "bzp", "bsp", "cdp"};

/// Statements without any surface: points, lines, curves, and what describes how surfaces look or are made
/// up.
constexpr std::array<std::string_view, 32> kNoSurface = {
    "vt",       "vn",       "vp",   "p",      "l",      "s",          "mg",        "bevel",
    "c_interp", "d_interp", "lod",  "usemap", "maplib", "shadow_obj", "trace_obj", "ctech",
    "stech",    "cstype",   "deg",  "bmat",   "step",   "curv",       "curv2",     "parm",
    "trim",     "hole",     "scrv", "sp",     "end",    "con",        "cdc",       "res"};

template <size_t n>
bool contains(const std::array<std::string_view, n>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// How often something occurs that is not read, and where first.
struct Unread {
  uint64_t count = 0;
  uint64_t first_line = 0;
  std::string first;

  void add(std::string_view what, uint64_t line) {
    if (count++ != 0) return;
    first = cleanName(what.substr(0, 20));
    first_line = line;
  }
};

/// Thrown to start again: a face uses a vertex that stands further down.
struct ForwardReference : std::exception {};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::filesystem::path& file, const SceneLoadOptions& options,
            const glm::dvec3& offset)
      : text_(text),
        file_(file),
        name_(file.string()),
        options_(options),
        offset_(offset),
        builder_(options, offset) {}

  Scene read() {
    try {
      parse(true, true);
    } catch (const ForwardReference&) {
      builder_ = SceneBuilder(options_, offset_);
      parse(true, false);
      all_vertices_known_ = true;
      parse(false, true);
    }
    markGlass();
    warnOfUnread();
    return builder_.finish(name_);
  }

 private:
  void parse(bool vertices, bool faces) {
    ObjLines lines(text_);
    lines_ = &lines;
    vertices_so_far_ = 0;
    add_vertices_ = vertices;
    object_.clear();
    group_.clear();
    libraries_.clear();
    runs_of_.clear();
    material_runs_ = nullptr;
    free_form_ = unknown_ = {};
    if (faces) builder_.beginObject("", kUnnamed);
    builder_.beginSurface(options_.cull_back_faces ? kSurfaceFrontOnly : 0u);
    while (lines.next()) {
      std::string_view rest = lines.line();
      const std::string_view keyword = takeWord(rest);
      if (keyword == "v") {
        vertex(rest);
      } else if (faces && !keyword.empty() && keyword[0] != '#') {
        statement(keyword, rest);
      }
    }
  }

  std::string place() const { return fmt::format("{}:{}", name_, lines_->number()); }

  void vertex(std::string_view rest) {
    ++vertices_so_far_;
    if (!add_vertices_) return;
    glm::vec3 position;
    glm::dvec3 full;
    for (int i = 0; i < 3; ++i) {
      const std::optional<Decimal> coordinate = takeDecimal(rest);
      if (!coordinate) failAtNumber(rest);
      position[i] = coordinate->single;
      full[i] = coordinate->full;
    }
    builder_.addPosition(position, full, [this] { return place(); });
  }

  [[noreturn]] void failAtNumber(std::string_view rest) const {
    const std::string_view word = takeWord(rest);
    const bool comma = word.find(',') != std::string_view::npos;
    throw Error(
        fmt::format("{}: expected three numbers after \"v\"{}", place(),
                    comma ? fmt::format(", with decimal points, and found \"{}\"; replace commas by points",
                                        cleanName(word.substr(0, 40)))
                          : ""));
  }

  /// Any statement but "v".
  void statement(std::string_view keyword, std::string_view rest) {
    if (keyword == "f" || keyword == "fo") {  // "fo" is what version 2 of the format called a face
      face(rest);
    } else if (keyword == "o") {
      object_ = cleanName(rest);
      group_.clear();
      beginObject();
    } else if (keyword == "g") {
      group_.clear();
      while (const auto word = nextWord(rest)) group_.append(group_.empty() ? "" : " ").append(*word);
      group_ = cleanName(group_);
      beginObject();
    } else if (keyword == "usemtl") {
      material_runs_ = &runs_of_[std::string(trimmed(rest))];
    } else if (keyword == "mtllib") {
      libraries_.emplace_back(trimmed(rest));
    } else if (contains(kFreeForm, keyword)) {
      free_form_.add(keyword, lines_->number());
    } else if (!contains(kNoSurface, keyword)) {
      unknown_.add(keyword, lines_->number());
    }
  }

  static std::optional<std::string_view> nextWord(std::string_view& rest) {
    const std::string_view word = takeWord(rest);
    return word.empty() ? std::nullopt : std::optional(word);
  }

  void face(std::string_view rest) {
    builder_.nextFace();
    corners_.clear();
    while (const auto word = nextWord(rest)) {
      const std::optional<int64_t> number = cornerNumber(*word);
      if (!number && !builder_.repairs()) {
        throw Error(
            fmt::format("{}: expected a vertex number (7, 7/1, 7//3 or 7/1/3) and found \"{}\"; "
                        "--repair drops the face",
                        place(), cleanName(word->substr(0, 40))));
      }
      addCorner(number.value_or(kBeyondAny));
    }
    const VertexRange vertices{0, int64_t(builder_.positionCount()), 1};
    const uint64_t before = builder_.triangleCount();
    builder_.addPolygon(corners_, vertices, [this] { return place(); });
    if (material_runs_ == nullptr) return;
    const uint64_t count = builder_.triangleCount() - before;
    if (!material_runs_->empty() && material_runs_->back().first + material_runs_->back().second == before) {
      material_runs_->back().second += count;
    } else {
      material_runs_->emplace_back(before, count);
    }
  }

  /// `number` as in the file: from 1, or from the last vertex back for negative ones; 0 is bad.
  void addCorner(int64_t number) {
    const int64_t corner = number < 0 ? vertices_so_far_ + number : number - 1;
    if (corner >= vertices_so_far_ && !all_vertices_known_) throw ForwardReference();
    corners_.push_back(corner);
  }

  void beginObject() {
    const bool both = !object_.empty() && !group_.empty() && object_ != group_;
    builder_.beginObject(both ? object_ + "/" + group_ : (group_.empty() ? object_ : group_), kUnnamed);
  }

  /// The files that an mtllib statement names: one whose name has blanks, if there is such a file, else a
  /// word each.
  std::set<std::string> filesOf(std::string library) const {
    std::replace(library.begin(), library.end(), '\\', '/');  // as Windows writes it
    std::error_code ignored;
    const auto whole = besideScene(file_, library, options_.allow_external);
    if (whole && std::filesystem::is_regular_file(*whole, ignored)) return {library};
    std::set<std::string> files;
    std::string_view rest = library;
    while (const auto word = nextWord(rest)) files.emplace(*word);
    return files;
  }

  /// Materials are read for what one sees through alone. A missing file is no error: many OBJ files come
  /// without theirs.
  void markGlass() {
    if (runs_of_.empty()) return;
    std::set<std::string, std::less<>> see_through;
    std::vector<std::string> problems;
    std::set<std::string> names;
    for (const std::string& library : libraries_) names.merge(filesOf(library));
    for (const std::string& name : names) {
      try {
        const auto file = besideScene(file_, name, options_.allow_external);
        if (!file)
          throw Error(fmt::format("{}: {} lies outside of the scene's folder (--allow-external)", name_,
                                  cleanName(name)));
        listSeeThrough(readFile(*file).view(), see_through);
      } catch (const Error& error) {
        problems.emplace_back(error.what());
      }
    }
    uint64_t triangles = 0;
    for (const auto& [name, runs] : runs_of_) {
      if (!see_through.contains(name)) continue;
      for (const auto& [first, count] : runs) {
        builder_.addToSurfaces(first, count, kSurfaceGlass);
        triangles += count;
      }
    }
    builder_.countGlass(triangles);
    if (problems.empty()) return;
    builder_.warn(fmt::format(
        "{}; {} materials count as opaque", problems[0],
        problems.size() == 1 ? "its" : fmt::format("its and {} other files'", problems.size() - 1)));
  }

  void warnOfUnread() {
    if (free_form_.count != 0) {
      builder_.warn(fmt::format("free-form surfaces, not read: {}, the first in line {}; export polygons",
                                free_form_.count, free_form_.first_line));
    }
    if (unknown_.count != 0) {
      builder_.warn(fmt::format("statements not understood, not read: {}, the first in line {} (\"{}\")",
                                unknown_.count, unknown_.first_line, unknown_.first));
    }
  }

  static constexpr const char* kUnnamed = "default";  // the format's own name for it

  std::string_view text_;
  const std::filesystem::path& file_;
  const std::string name_;
  const SceneLoadOptions& options_;
  const glm::dvec3& offset_;
  SceneBuilder builder_;
  ObjLines* lines_ = nullptr;
  int64_t vertices_so_far_ = 0;
  bool add_vertices_ = true;
  bool all_vertices_known_ = false;
  std::string object_;
  std::string group_;
  std::vector<int64_t> corners_;
  std::vector<std::string> libraries_;                      ///< what mtllib statements say
  using Runs = std::vector<std::pair<uint64_t, uint64_t>>;  ///< of triangles: first and count
  std::map<std::string, Runs> runs_of_;                     ///< by material
  Runs* material_runs_ = nullptr;                           ///< of the material in use
  Unread free_form_, unknown_;
};

}  // namespace

Scene loadObj(std::string_view bytes, const std::filesystem::path& file, const SceneLoadOptions& options,
              const glm::dvec3& offset) {
  return ObjReader(bytes, file, options, offset).read();
}

}  // namespace sightline
