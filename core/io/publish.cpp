#include "core/io/publish.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/error.h"

namespace sightline {
namespace {

[[noreturn]] void failOn(const std::filesystem::path& file, const char* action) {
  throw Error(fmt::format("{}: cannot {}: {}", file.string(), action, std::strerror(errno)));
}

/// Whether the file's bytes are on the disk, as far as its file system can say.
bool flushed(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP;
}

/// Without it the rename may be lost with the power. Some file systems cannot; then the rename must do.
void flushFolder(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

void writeAll(int descriptor, std::span<const uint8_t> bytes, const std::filesystem::path& file) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) failOn(file, "write");
    bytes = bytes.subspan(size_t(written));
  }
}

void publish(int descriptor, const std::filesystem::path& from, const std::filesystem::path& to) {
  if (!flushed(descriptor)) failOn(from, "flush to disk");
  if (::rename(from.c_str(), to.c_str()) != 0) failOn(to, "put in place");
  flushFolder(to);
}

}  // namespace sightline
