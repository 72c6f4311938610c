#include "core/pvs/pvs_writer.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/pvs/publish.h"
#include "core/pvs/pvs_sections.h"

namespace sightline {
namespace {

/// Bytes read at a time to hash what an earlier run wrote.
constexpr size_t kHashChunk = 1 << 20;

[[noreturn]] void failOn(const std::filesystem::path& part, const char* action) {
  throw Error(fmt::format("{}: cannot {}: {}", part.string(), action, std::strerror(errno)));
}

/// Whether the descriptor still is the file of that name: a bake that ended meanwhile has renamed it.
bool sameFile(int descriptor, const std::filesystem::path& part) {
  struct stat opened = {}, named = {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(part.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// Closes the descriptor if a constructor fails after it was opened.
struct DescriptorGuard {
  int descriptor;
  ~DescriptorGuard() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

}  // namespace

PvsWriter::PvsWriter(const std::filesystem::path& part)
    : part_(part), checksum_(XXH3_createState(), &XXH3_freeState) {
  if (!checksum_) throw std::bad_alloc();
  XXH3_64bits_reset(checksum_.get());
  DescriptorGuard guard{::open(part.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)};
  if (guard.descriptor < 0) failOn(part, "create");
  if (::flock(guard.descriptor, LOCK_EX | LOCK_NB) != 0 || !sameFile(guard.descriptor, part)) {
    throw Error(
        fmt::format("{}: another bake is writing it; wait for it or choose another -o", part.string()));
  }
  std::swap(descriptor_, guard.descriptor);
}

PvsWriter::PvsWriter(const std::filesystem::path& part, const PvsFile& head) : PvsWriter(part) {
  if (::ftruncate(descriptor_, 0) != 0) failOn(part, "empty");
  write(writePrelude());
  write(writeSection(kSectionHead, writeHeadPayload(head)));
}

PvsWriter::PvsWriter(const std::filesystem::path& part, const PartialPvs& left) : PvsWriter(part) {
  cells_ = uint32_t(left.pvs.cells.size());
  if (::ftruncate(descriptor_, off_t(left.whole_bytes)) != 0) failOn(part, "cut");
  std::vector<char> chunk(kHashChunk);
  for (uint64_t todo = left.whole_bytes; todo != 0;) {
    const ssize_t got = ::read(descriptor_, chunk.data(), size_t(std::min<uint64_t>(todo, chunk.size())));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) failOn(part, "read");
    XXH3_64bits_update(checksum_.get(), chunk.data(), size_t(got));
    todo -= uint64_t(got);
  }
}

PvsWriter::~PvsWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void PvsWriter::write(const Bytes& bytes) {
  writeAll(descriptor_, bytes, part_);
  XXH3_64bits_update(checksum_.get(), bytes.data(), bytes.size());
  if (::fdatasync(descriptor_) != 0) failOn(part_, "flush to disk");
}

void PvsWriter::append(const CellPvs& cell) {
  write(writeSection(kSectionCell, writeCellPayload(cell, cells_)));
  ++cells_;
}

void PvsWriter::finish(const std::filesystem::path& file) {
  write(writeSection(kSectionEnd, writeEndPayload(cells_, XXH3_64bits_digest(checksum_.get()))));
  publish(descriptor_, part_, file);
}

}  // namespace sightline
