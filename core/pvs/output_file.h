#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace sightline {

/// A file that appears under its name only when it is whole and on the disk: writes go to "NAME.tmp" beside
/// it, commit() flushes and renames. Without commit() the temporary file goes away. All throw Error.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  int descriptor_ = -1;
};

/// Writes all bytes. Throws Error that names `file`.
void writeAll(int descriptor, std::span<const uint8_t> bytes, const std::filesystem::path& file);

/// Flushes the file to the disk, renames it to `to` and flushes the folder. Throws Error.
void publish(int descriptor, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace sightline
