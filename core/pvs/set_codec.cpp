#include "core/pvs/set_codec.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
#include <new>
#include <numeric>

#include "core/io/varint.h"

namespace sightline {
namespace {

/// zstd's default. Level 19 packs ten times slower to save a tenth at most.
constexpr int kZstdLevel = 3;

}  // namespace

Bytes compress(std::span<const uint8_t> bytes) {
  Bytes frame(ZSTD_compressBound(bytes.size()));
  const size_t size = ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the bound excludes every other reason
  frame.resize(size);
  return frame;
}

std::optional<Bytes> decompress(std::span<const uint8_t> frame, uint64_t limit) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          &ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  ZSTD_inBuffer source{frame.data(), frame.size(), 0};
  Bytes content;
  // Piece by piece: a frame's claimed size must not decide how much is allocated.
  for (size_t todo = 1; todo != 0;) {
    const size_t old_size = content.size();
    if (old_size > limit) return std::nullopt;
    content.resize(old_size + ZSTD_DStreamOutSize());
    ZSTD_outBuffer target{content.data() + old_size, content.size() - old_size, 0};
    const size_t source_before = source.pos;
    todo = ZSTD_decompressStream(stream.get(), &target, &source);
    content.resize(old_size + target.pos);
    if (ZSTD_isError(todo)) return std::nullopt;
    if (todo != 0 && target.pos == 0 && source.pos == source_before) return std::nullopt;  // cut end
  }
  if (source.pos != source.size || content.size() > limit) return std::nullopt;
  return content;
}

Bytes encodeSet(std::span<const uint32_t> ids) {
  Bytes runs;
  uint32_t expected = 0;  // id that a gap of 0 would stand for
  for (size_t first = 0; first < ids.size();) {
    size_t end = first + 1;
    while (end < ids.size() && ids[end] == ids[end - 1] + 1) ++end;
    appendVarint(runs, ids[first] - expected);
    appendVarint(runs, uint32_t(end - first - 1));
    expected = ids[end - 1] + 1;
    first = end;
  }
  return compress(runs);
}

std::optional<std::vector<uint32_t>> decodeSet(std::span<const uint8_t> bytes, uint64_t count,
                                               uint64_t id_limit) {
  if (count > id_limit) return std::nullopt;
  const auto runs = decompress(bytes, count * 2 * kMaxVarintBytes);
  if (!runs) return std::nullopt;
  std::vector<uint32_t> ids;
  uint64_t next = 0;
  for (size_t at = 0; at < runs->size();) {
    const auto gap = readVarint(*runs, at);
    const auto more = gap ? readVarint(*runs, at) : std::nullopt;
    if (!more) return std::nullopt;
    const uint64_t first = next + *gap, length = uint64_t(*more) + 1;
    if (first + length > id_limit || length > count - ids.size()) return std::nullopt;
    ids.resize(ids.size() + length);
    std::iota(ids.end() - ptrdiff_t(length), ids.end(), uint32_t(first));
    next = first + length;
  }
  if (ids.size() != count) return std::nullopt;
  return ids;
}

}  // namespace sightline
