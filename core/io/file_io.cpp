#include "core/io/file_io.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "core/base/error.h"
#include "core/io/publish.h"

namespace sightline {
namespace {

std::string reason(int error_number) {
  return std::strerror(error_number);
}

/// Links in a row that are followed, as Linux does.
constexpr int kLongestLinkChain = 40;

/// Closes a file descriptor at the end of a scope.
struct Descriptor {
  int value = -1;
  ~Descriptor() {
    if (value >= 0) close(value);
  }
};

}  // namespace

bool beginsWith(const std::filesystem::path& file, std::span<const uint8_t> magic) {
  std::vector<char> start(magic.size(), 0);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) {
    std::ifstream(file, std::ios::binary).read(start.data(), std::streamsize(start.size()));
  }
  return std::ranges::equal(start, magic, {}, [](char c) { return uint8_t(c); });
}

FileBytes readFile(const std::filesystem::path& file) {
  // Not blocking, so that a pipe without a writer is refused below and not waited for.
  const Descriptor descriptor{open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (descriptor.value < 0) throw Error(fmt::format("{}: cannot open: {}", file.string(), reason(errno)));
  struct stat status {};
  if (fstat(descriptor.value, &status) != 0) {
    throw Error(fmt::format("{}: cannot read: {}", file.string(), reason(errno)));
  }
  if (S_ISDIR(status.st_mode)) throw Error(fmt::format("{}: is a directory, not a file", file.string()));
  if (!S_ISREG(status.st_mode)) throw Error(fmt::format("{}: is not a regular file", file.string()));

  FileBytes bytes;
  const size_t expected = size_t(status.st_size);
  try {
    bytes.data = std::make_unique_for_overwrite<char[]>(expected);
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format("{}: {} bytes do not fit into memory", file.string(), expected));
  }
  while (bytes.size < expected) {
    const ssize_t got = read(descriptor.value, bytes.data.get() + bytes.size, expected - bytes.size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Error(fmt::format("{}: cannot read: {}", file.string(), reason(errno)));
    if (got == 0) throw Error(fmt::format("{}: became shorter while it was read", file.string()));
    bytes.size += size_t(got);
  }
  return bytes;
}

void requireReplaceable(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) || std::filesystem::is_regular_file(file, ignored)) return;
  throw Error(fmt::format("{}: is not a regular file, so it is not replaced; name another", file.string()));
}

OutputFile::OutputFile(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code ignored;
  for (int links = 0; links < kLongestLinkChain && std::filesystem::is_symlink(file_, ignored); ++links) {
    file_ = file_.parent_path() / std::filesystem::read_symlink(file_, ignored);
  }
  requireReplaceable(file_);
  // A name that nobody else writes to: another process, or this one on another thread.
  int descriptor = -1;
  for (uint32_t i = 0; descriptor < 0; ++i) {
    temporary_ = file_;
    temporary_ += fmt::format(".tmp{}-{}", getpid(), i);
    descriptor = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) fail("create");
  }
  stream_ = fdopen(descriptor, "wb");
  if (stream_ != nullptr) return;
  close(descriptor);
  std::remove(temporary_.c_str());
  throw std::bad_alloc();  // the one reason that fdopen has
}

OutputFile::~OutputFile() {
  if (stream_ == nullptr) return;
  std::fclose(stream_);
  std::remove(temporary_.c_str());
}

void OutputFile::fail(const char* what) {
  throw Error(fmt::format("{}: cannot {}: {}", file_.string(), what, reason(errno)));
}

void OutputFile::write(const void* bytes, size_t size) {
  if (size != 0 && std::fwrite(bytes, 1, size, stream_) != size) fail("write");
}

void OutputFile::commit() {
  if (std::fflush(stream_) != 0) fail("write");
  publish(fileno(stream_), temporary_, file_);
  std::FILE* stream = stream_;
  stream_ = nullptr;
  if (std::fclose(stream) != 0) fail("close");
}

void saveText(std::string_view text, const std::filesystem::path& file) {
  OutputFile output(file);
  output.write(text);
  output.commit();
}

void makeFolder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) {
    throw Error(fmt::format("{}: cannot make this folder: {}", folder.string(), problem.message()));
  }
}

void requireSeparate(std::span<const std::filesystem::path> outputs,
                     std::span<const std::filesystem::path> inputs) {
  const auto same = [](const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code code;
    if (std::filesystem::equivalent(a, b, code)) return true;
    const auto full = [&](const std::filesystem::path& file) {
      return std::filesystem::weakly_canonical(std::filesystem::absolute(file, code), code);
    };
    return full(a) == full(b);
  };
  for (size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const std::filesystem::path& input : inputs) {
      if (input.empty() || !same(outputs[i], input)) continue;
      throw Error(
          fmt::format("{}: would be read and replaced; name another file to write", outputs[i].string()),
          kExitUsage);
    }
    for (size_t other = 0; other < i; ++other) {
      if (outputs[other].empty() || !same(outputs[i], outputs[other])) continue;
      throw Error(fmt::format("{}: would be written twice; name another file", outputs[i].string()),
                  kExitUsage);
    }
  }
}

std::string lowerExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace sightline
