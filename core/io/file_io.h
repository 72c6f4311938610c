#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
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

/// Whether a regular file begins so; false for one that cannot be read. Pipes are not: they would keep us
/// waiting.
bool beginsWith(const std::filesystem::path& file, std::span<const uint8_t> magic);

/// Throws Error if something is there that must not be replaced: a folder, a device, a pipe. Links are
/// followed.
void requireReplaceable(const std::filesystem::path& file);

/// A file that appears under its name only when it is complete: bytes go to a temporary name beside it,
/// commit() flushes it to the disk and renames it. Without commit the temporary file is removed. A link is
/// followed; what must not be replaced is not (requireReplaceable). All throw Error with file and reason.
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

/// Writes all of a file (OutputFile).
void saveText(std::string_view text, const std::filesystem::path& file);

/// Makes the folder and those above it, where they are missing. Throws Error.
void makeFolder(const std::filesystem::path& folder);

/// Throws Error if one of the files to write (empty: none) is one of those to read, or another to write: a
/// slip of the hand must not cost a scene.
void requireSeparate(std::span<const std::filesystem::path> outputs,
                     std::span<const std::filesystem::path> inputs);

/// The extension in lower case, with its dot: ".obj"; empty if there is none.
std::string lowerExtension(const std::filesystem::path& file);

}  // namespace sightline
