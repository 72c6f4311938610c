#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/formats/obj_lines.h"
#include "core/strip/strip_formats.h"

namespace sightline {
namespace {

/// v, vt, vn: what corners number.
constexpr int kObjLists = 3;

/// Vertices of one kind: how many there are so far, which of them stay, and their new numbers from 0.
struct ObjList {
  int64_t so_far = 0;
  std::vector<bool> used;
  std::vector<uint64_t> new_number;  ///< one more than there are: the last is their count

  /// The place of a number as the file has it: from 1, or back from the last so far.
  int64_t placeOf(int64_t number) const { return number < 0 ? so_far + number : number - 1; }

  void use(int64_t number) {
    const int64_t place = placeOf(number);
    if (place < 0) return;  // 0, or in front of the first: no vertex
    if (size_t(place) >= used.size()) used.resize(size_t(place) + 1, false);
    used[size_t(place)] = true;
  }

  void number() {
    used.resize(std::max<size_t>(used.size(), size_t(so_far)), false);
    uint64_t next = 0;
    for (const bool stays : used) {
      new_number.push_back(next);
      next += stays ? 1 : 0;
    }
    new_number.push_back(next);
  }

  int64_t renumbered(int64_t number) const {
    const int64_t place = placeOf(number);
    if (place < 0 || size_t(place) >= used.size()) return number;
    const auto now = int64_t(new_number[size_t(place)]);
    return number < 0 ? now - int64_t(new_number[size_t(so_far)]) : now + 1;
  }
};

/// Calls visit(list, number, where) for each number of the corners in the statement's text behind its
/// keyword.
template <typename Visit>
void forCorners(std::string_view text, const Visit& visit) {
  for (std::string_view word = takeWord(text); !word.empty(); word = takeWord(text)) {
    int list = 0;
    for (size_t at = 0; at <= word.size() && list < kObjLists; ++list) {
      const std::string_view field = word.substr(at, word.find('/', at) - at);
      int64_t number = 0;
      const char* begin = field.data() + (field.starts_with('+') ? 1 : 0);
      const auto result = std::from_chars(begin, field.data() + field.size(), number);
      if (!field.empty() && result.ec == std::errc() && result.ptr == field.data() + field.size()) {
        visit(list, number, field);
      }
      at += field.size() + 1;
    }
  }
}

/// The parts of a statement that spans lines: its bytes without comments, backslashes and line ends, which
/// would be taken for words.
std::vector<std::string_view> partsOf(std::string_view raw) {
  std::vector<std::string_view> parts;
  while (!raw.empty()) {
    const std::string_view line = raw.substr(0, raw.find_first_of("\r\n"));
    raw.remove_prefix(line.size());
    raw.remove_prefix(std::min(raw.find_first_not_of("\r\n"), raw.size()));
    const std::string_view text = line.substr(0, line.find('#'));
    parts.push_back(text.substr(0, text.find('\\')));
  }
  return parts;
}

class ObjStripper {
 public:
  explicit ObjStripper(const StripInput& input) : input_(input) {
    kept_ = keptFaces(input, stripped_.report);
  }

  Stripped run() {
    bool compact = input_.options.compact;
    if (compact) {
      walk([&](const ObjLines& lines, std::string_view keyword, bool stays) {
        if (stays) use(lines, keyword);
      });
      if (has_free_form_) {
        compact = false;
        stripped_.report.notes.push_back("vertices all stay: curves, surfaces or lines may use them");
      }
      for (ObjList& list : lists_) list.number();
    }
    std::string text;
    text.reserve(input_.bytes.size());
    if (input_.bytes.starts_with("\xef\xbb\xbf")) text += input_.bytes.substr(0, 3);
    walk([&](const ObjLines& lines, std::string_view keyword, bool stays) {
      if (!stays) return;
      if (compact) {
        writeCompact(lines, keyword, text);
      } else {
        text += lines.raw();
      }
    });
    stripped_.report.bytes_before = input_.bytes.size();
    stripped_.report.bytes = text.size();
    stripped_.files.push_back({input_.out, std::move(text)});
    return std::move(stripped_);
  }

 private:
  /// Calls visit(lines, keyword, stays) for each line; lists' so_far then are as before it.
  template <typename Visit>
  void walk(const Visit& visit) {
    for (ObjList& list : lists_) list.so_far = 0;
    size_t face = 0;
    ObjLines lines(input_.bytes);
    while (lines.next()) {
      std::string_view rest = lines.line();
      const std::string_view keyword = takeWord(rest);
      bool stays = true;
      if (keyword == "f" || keyword == "fo") {
        stays = face < kept_.size() && kept_[face];
        ++face;
      }
      visit(lines, keyword, stays);
      const int list = listOf(keyword);
      if (list >= 0) ++lists_[size_t(list)].so_far;
    }
  }

  static int listOf(std::string_view keyword) {
    return keyword == "v" ? 0 : keyword == "vt" ? 1 : keyword == "vn" ? 2 : -1;
  }

  static bool hasCorners(std::string_view keyword) {
    return keyword == "f" || keyword == "fo" || keyword == "l" || keyword == "p";
  }

  void use(const ObjLines& lines, std::string_view keyword) {
    constexpr std::array<std::string_view, 7> kFreeForm = {"curv", "curv2", "surf", "cstype",
                                                           "bzp",  "bsp",   "cdp"};
    if (std::find(kFreeForm.begin(), kFreeForm.end(), keyword) != kFreeForm.end()) has_free_form_ = true;
    if (!hasCorners(keyword)) return;
    // Of points and lines a backslash does not join what follows (ObjLines).
    if (keyword[0] != 'f' && trimmed(lines.line()).ends_with('\\')) has_free_form_ = true;
    for (std::string_view part : partsOf(lines.raw())) {
      forCorners(part, [&](int list, int64_t number, std::string_view) { lists_[size_t(list)].use(number); });
    }
  }

  void writeCompact(const ObjLines& lines, std::string_view keyword, std::string& text) const {
    const std::string_view raw = lines.raw();
    const int kind = listOf(keyword);
    if (kind >= 0) {
      const ObjList& list = lists_[size_t(kind)];
      if (list.used[size_t(list.so_far)]) text += raw;
      return;
    }
    if (!hasCorners(keyword)) {
      text += raw;
      return;
    }
    const char* copied = raw.data();
    for (std::string_view part : partsOf(raw)) {
      forCorners(part, [&](int list, int64_t number, std::string_view where) {
        text.append(copied, where.data());
        text += fmt::format("{}", lists_[size_t(list)].renumbered(number));
        copied = where.data() + where.size();
      });
    }
    text.append(copied, raw.data() + raw.size());
  }

  const StripInput& input_;
  Stripped stripped_;
  std::vector<bool> kept_;
  std::array<ObjList, kObjLists> lists_;
  bool has_free_form_ = false;
};

}  // namespace

Stripped stripObj(const StripInput& input) {
  return ObjStripper(input).run();
}

}  // namespace sightline
