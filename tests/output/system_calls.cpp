#include "tests/output/system_calls.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <mutex>

namespace sightline {

std::vector<std::string> SystemCalls::log;
bool SystemCalls::reads_fail = false;

}  // namespace sightline

using sightline::SystemCalls;

namespace {

/// Threads may save at once.
void note(const std::string& call) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  SystemCalls::log.push_back(call);
}

}  // namespace

extern "C" int fsync(int descriptor) {
  const auto file = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor));
  note("fsync " + file.filename().string() + (std::filesystem::is_directory(file) ? "/" : ""));
  return int(::syscall(SYS_fsync, descriptor));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  note("rename " + std::filesystem::path(from).filename().string() + " " +
       std::filesystem::path(to).filename().string());
  return int(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

extern "C" ssize_t read(int descriptor, void* bytes, size_t size) {
  if (SystemCalls::reads_fail) {
    errno = EIO;
    return -1;
  }
  return ::syscall(SYS_read, descriptor, bytes, size);
}
