#include "core/formats/obj_lines.h"

#include <algorithm>

namespace sightline {
namespace {

constexpr std::string_view kBlanks = " \t\r";

/// What some editors put before UTF-8 text.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// Where a comment starts; a '#' behind a point, as in the "1.#QNAN" of some runtimes, is part of a number.
size_t commentStart(std::string_view line) {
  size_t at = line.find('#');
  while (at != std::string_view::npos && at > 0 && line[at - 1] == '.' && at + 1 < line.size() &&
         line[at + 1] >= 'A' && line[at + 1] <= 'Z') {
    at = line.find('#', at + 1);
  }
  return at;
}

/// Whether a backslash, and at most blanks behind it, ends the line; not if that belongs to a comment.
bool isContinued(std::string_view line) {
  const size_t last = line.find_last_not_of(kBlanks);
  return last != std::string_view::npos && line[last] == '\\' && commentStart(line) == std::string_view::npos;
}

}  // namespace

std::string_view takeWord(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

ObjLines::ObjLines(std::string_view text) : rest_(text) {
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

bool ObjLines::next() {
  if (rest_.empty()) return false;
  number_ = taken_ + 1;
  raw_ = rest_;
  line_ = takeLine();
  const size_t keyword = line_.find_first_not_of(kBlanks);
  if (keyword == std::string_view::npos || (line_[keyword] != 'v' && line_[keyword] != 'f')) return true;
  if (isContinued(line_)) joinContinued();
  line_ = line_.substr(0, commentStart(line_));
  return true;
}

std::string_view ObjLines::takeLine() {
  // Two searches for one character are faster than one for either, and most files have no CR.
  size_t end = std::min(rest_.find('\n'), rest_.size());
  end = std::min(rest_.substr(0, end).find('\r'), end);
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end);
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : (rest_.empty() ? 0 : 1));
  ++taken_;
  return line;
}

void ObjLines::joinContinued() {
  joined_.clear();
  std::string_view part = line_;
  for (; isContinued(part) && !rest_.empty(); part = takeLine()) {
    joined_.append(part.substr(0, part.find_last_of('\\'))) += ' ';
  }
  line_ = joined_.append(part);
}

}  // namespace sightline
