#pragma once
#include <filesystem>
#include <span>
#include <string_view>

namespace sightline {

/// Whether it is "-", which stands for standard output and never for a file of that name (./- does).
bool isStandardOutput(const std::filesystem::path& file);

/// The text that a command writes: reports, tables, pages, exports. While it lives, and one of them goes to
/// standard output, all that is printed goes to standard error instead, progress too, so that the text can be
/// piped.
class TextOutputs {
 public:
  /// files: those to write, empty ones are not asked for. Throws Error if one cannot be written: before the
  /// work, not after it.
  explicit TextOutputs(std::span<const std::filesystem::path> files);
  ~TextOutputs();
  TextOutputs(const TextOutputs&) = delete;
  TextOutputs& operator=(const TextOutputs&) = delete;

  /// Writes all of one of the files; does nothing if it is empty.
  void save(std::string_view text, const std::filesystem::path& file) const;
  /// Writes to standard output, which must be one of the files. A pipe whose reader went away (| head) is no
  /// error.
  void write(std::string_view text) const;

 private:
  int output_ = -1;  ///< descriptor of standard output as it was; -1: none of the files goes there
};

}  // namespace sightline
