#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/io/byte_stream.h"

namespace sightline {

/// Packs ascending, unique ids: runs of consecutive ids as (gap, length - 1) in variable-length integers,
/// then zstd. Visible triangles come in runs, because file order follows surfaces. It takes
/// a third to a sixth of CRoaring's room (docs/benchmarks.md).
Bytes encodeSet(std::span<const uint32_t> ids);

/// Undoes encodeSet. Nothing if the bytes are damaged, do not hold exactly `count` ids, or hold one that is
/// not below `id_limit`. Memory grows with the ids found, not with what `count` claims; but a few
/// bytes can hold a run of all ids below the limit.
std::optional<std::vector<uint32_t>> decodeSet(std::span<const uint8_t> bytes, uint64_t count,
                                               uint64_t id_limit);

/// One zstd frame.
Bytes compress(std::span<const uint8_t> bytes);

/// The content of exactly one zstd frame; nothing if it is damaged or longer than `limit`.
std::optional<Bytes> decompress(std::span<const uint8_t> frame, uint64_t limit);

}  // namespace sightline
