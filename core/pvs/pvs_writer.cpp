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

#include "core/pvs/pvs_sections.h"
#include "core/scene/publish.h"

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
  DescriptorGuard guard{::open(part.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)};
  if (guard.descriptor < 0) failOn(part, "create");
  if (::flock(guard.descriptor, LOCK_EX | LOCK_NB) != 0 || !sameFile(guard.descriptor, part)) {
    throw Error(
        fmt::format("{}: another bake is writing it; wait for it or choose another -o", part.string()));
  }
  std::swap(descriptor_, guard.descriptor);
}

PvsWriter::~PvsWriter() {
  struct stat status = {};
  if (::fstat(descriptor_, &status) == 0 && status.st_size == 0) ::unlink(part_.c_str());
  ::close(descriptor_);
}

void PvsWriter::begin(const PvsFile& head) {
  if (::ftruncate(descriptor_, 0) != 0 || ::lseek(descriptor_, 0, SEEK_SET) != 0) failOn(part_, "empty");
  XXH3_64bits_reset(checksum_.get());
  cells_ = 0;
  has_witnesses_ = head.has_witnesses;
  write(writePrelude());
  write(writeSection(kSectionHead, writeHeadPayload(head)));
}

void PvsWriter::goOn(const PartialPvs& left) {
  if (::ftruncate(descriptor_, off_t(left.whole_bytes)) != 0 || ::lseek(descriptor_, 0, SEEK_SET) != 0) {
    failOn(part_, "cut");
  }
  XXH3_64bits_reset(checksum_.get());
  cells_ = uint32_t(left.pvs.cells.size());
  has_witnesses_ = left.pvs.has_witnesses;
  std::vector<char> chunk(kHashChunk);
  for (uint64_t todo = left.whole_bytes; todo != 0;) {
    const ssize_t got = ::read(descriptor_, chunk.data(), size_t(std::min<uint64_t>(todo, chunk.size())));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) failOn(part_, "read");
    XXH3_64bits_update(checksum_.get(), chunk.data(), size_t(got));
    todo -= uint64_t(got);
  }
}

void PvsWriter::write(const Bytes& bytes) {
  writeAll(descriptor_, bytes, part_);
  XXH3_64bits_update(checksum_.get(), bytes.data(), bytes.size());
  if (::fdatasync(descriptor_) != 0) failOn(part_, "flush to disk");
}

void PvsWriter::append(const CellPvs& cell) {
  if (cell.witnesses.size() != (has_witnesses_ ? cell.triangles.size() : 0)) {
    throw Error(fmt::format("{}: cell {} has {} witnesses for {} triangles: an error of this program",
                            part_.string(), cell.cell.name, cell.witnesses.size(), cell.triangles.size()));
  }
  write(writeSection(kSectionCell, writeCellPayload(cell, cells_)));
  ++cells_;
}

void PvsWriter::finish(const std::filesystem::path& file) {
  write(writeSection(kSectionEnd, writeEndPayload(cells_, XXH3_64bits_digest(checksum_.get()))));
  publish(descriptor_, part_, file);
}

}  // namespace sightline
