#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace sightline {

/// Takes the first word, and the blanks before it, off the text; empty at its end.
std::string_view takeWord(std::string_view& text);

/// The text without blanks at either end.
std::string_view trimmed(std::string_view text);

/// Serves the text of an OBJ or MTL file line by line, whichever of CR, LF and CRLF ends them. Joins lines of
/// vertices and faces that a backslash continues, and cuts comments off those.
class ObjLines {
 public:
  explicit ObjLines(std::string_view text);

  /// Goes on to the next line; false after the last.
  bool next();
  /// Without its end; valid until the next.
  std::string_view line() const { return line_; }
  /// Of the file's lines, from 1; of several that are joined the first.
  uint64_t number() const { return number_; }
  /// The bytes of the text that it stands in, line ends, comments and backslashes included.
  std::string_view raw() const { return raw_.substr(0, raw_.size() - rest_.size()); }

 private:
  std::string_view takeLine();
  void joinContinued();

  std::string_view rest_;
  std::string_view raw_;  ///< from the line's begin to the text's end
  std::string_view line_;
  std::string joined_;  ///< what line_ shows if it is more than one line of the file
  uint64_t number_ = 0;
  uint64_t taken_ = 0;  ///< of the file's lines
};

}  // namespace sightline
