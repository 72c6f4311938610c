#pragma once
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace sightline {

/// The bytes of a file in memory.
struct FileBytes {
  std::unique_ptr<char[]> data;
  size_t size = 0;
  std::string_view view() const { return {data.get(), size}; }
};

/// Reads a whole regular file. Throws Error: no such file, a directory, not readable, too large.
FileBytes readFile(const std::filesystem::path& file);

/// A file that appears under its name only when it is complete: bytes go to a temporary name beside it,
/// commit() renames. Without commit the temporary file is removed. All throw Error with file and reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* bytes, size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();

 private:
  [[noreturn]] void fail(const char* what);

  std::filesystem::path file_;
  std::filesystem::path temporary_;
  std::FILE* stream_ = nullptr;
};

/// The extension in lower case, with its dot: ".obj"; empty if there is none.
std::string lowerExtension(const std::filesystem::path& file);

}  // namespace sightline
