#include "core/pvs/pvs_writer.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/base/error.h"
#include "core/io/publish.h"
#include "core/pvs/checksum.h"
#include "core/pvs/pvs_sections.h"

namespace sightline {
namespace {

/// Bytes copied at a time into the finished file.
constexpr size_t kCopyChunk = 1 << 20;

[[noreturn]] void failOn(const std::filesystem::path& part, const char* action) {
  throw Error(fmt::format("{}: cannot {}: {}", part.string(), action, std::strerror(errno)));
}

/// Whether the descriptor still is the file of that name: a bake that ended meanwhile has renamed it.
bool sameFile(int descriptor, const std::filesystem::path& part) {
  struct stat opened = {}, named = {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(part.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// Closes the descriptor at the end of a scope, unless it was taken.
struct DescriptorGuard {
  int descriptor;
  ~DescriptorGuard() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

}  // namespace

PvsWriter::PvsWriter(const std::filesystem::path& part) : part_(part) {
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
  setHead(head);
  size_ = 0;
  costs_ = {};
  write(writePrelude(kPvsMagic, versionOf(head)));
  write(writeSection(kSectionHead, writeHeadPayload(head)));
  places_ = {{0, size_}};
}

void PvsWriter::goOn(const PartialPvs& left) {
  size_ = left.whole_bytes;
  if (::ftruncate(descriptor_, off_t(size_)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0) {
    failOn(part_, "cut");
  }
  setHead(left.pvs);
  places_ = left.places;
  costs_ = {};
  for (uint32_t index = 0; index < cells(); ++index)
    writeCost(costs_, costOf(left.pvs.cells[index], index), head_);
}

void PvsWriter::setHead(const PvsFile& head) {
  head_ = {};
  head_.has_witnesses = head.has_witnesses;
  head_.doors = head.doors;
}

void PvsWriter::write(const Bytes& bytes) {
  writeAll(descriptor_, bytes, part_);
  if (::fdatasync(descriptor_) != 0) failOn(part_, "flush to disk");
  size_ += bytes.size();
}

void PvsWriter::append(const CellPvs& cell) {
  const CellCost cost = costOf(cell, cells());
  ByteWriter own_cost, both;
  writeCost(own_cost, cost, head_);
  both.raw(writeSection(kSectionCell, writeCellPayload(cell, cells(), head_)));
  const ByteRange place{size_, both.bytes().size()};
  both.raw(writeSection(kSectionCost, own_cost.bytes()));
  write(both.bytes());
  places_.push_back(place);
  writeCost(costs_, cost, head_);
}

void PvsWriter::writeFinished(int descriptor, const std::filesystem::path& file) const {
  Checksum checksum;
  const auto writeOn = [&](std::span<const uint8_t> bytes) {
    writeAll(descriptor, bytes, file);
    checksum.add(bytes);
  };
  Bytes chunk(kCopyChunk);
  for (ByteRange todo : places_) {
    while (todo.size != 0) {
      const size_t most = size_t(std::min<uint64_t>(todo.size, chunk.size()));
      const ssize_t got = ::pread(descriptor_, chunk.data(), most, off_t(todo.offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) failOn(part_, "read");
      writeOn(std::span(chunk).first(size_t(got)));
      todo.offset += uint64_t(got);
      todo.size -= uint64_t(got);
    }
  }
  writeOn(writeSection(kSectionCost, costs_.bytes()));
  writeOn(writeSection(kSectionEnd, writeEndPayload(cells(), checksum.value())));
}

void PvsWriter::finish(const std::filesystem::path& file) {
  auto finished = part_;
  finished += ".tmp";
  // The lock on the part file is one on this name, too; the new file takes it over before it has the name.
  DescriptorGuard guard{::open(finished.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
  if (guard.descriptor < 0) failOn(finished, "create");
  try {
    if (::flock(guard.descriptor, LOCK_EX | LOCK_NB) != 0) failOn(finished, "lock");
    writeFinished(guard.descriptor, finished);
    publish(guard.descriptor, finished, part_);
  } catch (...) {
    ::unlink(finished.c_str());
    throw;
  }
  std::swap(descriptor_, guard.descriptor);
  publish(descriptor_, part_, file);
}

}  // namespace sightline
