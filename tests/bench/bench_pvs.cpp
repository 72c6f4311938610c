// How much room a set takes and how fast it is read: the file's codec, the alternatives that were weighed,
// and CRoaring where libroaring-dev is installed.
//
//   bench_pvs FILE.pvs...
#include <fmt/core.h>
#include <zstd.h>
#ifdef SL_HAVE_ROARING
#include <roaring/roaring.h>
#endif

#include <algorithm>
#include <bit>
#include <chrono>
#include <functional>
#include <stdexcept>

#include "core/base/error.h"
#include "core/pvs/pvs_file.h"
#include "core/pvs/set_codec.h"

namespace sightline {
namespace {

using Ids = std::vector<uint32_t>;

struct Codec {
  std::string name;
  std::function<Bytes(const Ids&)> encode;
  std::function<Ids(const Bytes&, size_t count)> decode;
};

/// Repetitions of a measurement; the first is dropped, the median counts.
constexpr int kRepetitions = 15;

double medianSeconds(const std::function<void()>& work) {
  work();
  std::vector<double> seconds;
  for (int i = 0; i < kRepetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + kRepetitions / 2, seconds.end());
  return seconds[kRepetitions / 2];
}

Bytes zip(const Bytes& bytes, int level) {
  Bytes frame(ZSTD_compressBound(bytes.size()));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), level));
  return frame;
}

/// Gaps between neighbours, 7 bits a byte.
Bytes gapBytes(const Ids& ids) {
  Bytes bytes;
  uint32_t expected = 0;
  for (uint32_t id : ids) {
    uint32_t gap = id - expected;
    for (; gap >= 0x80; gap >>= 7) bytes.push_back(uint8_t(gap | 0x80));
    bytes.push_back(uint8_t(gap));
    expected = id + 1;
  }
  return bytes;
}

Ids fromGapBytes(const Bytes& bytes) {
  Ids ids;
  uint32_t expected = 0, gap = 0;
  unsigned shift = 0;
  for (uint8_t byte : bytes) {
    gap |= uint32_t(byte & 0x7f) << shift;
    shift += 7;
    if (byte >= 0x80) continue;
    ids.push_back(expected + gap);
    expected += gap + 1;
    gap = shift = 0;
  }
  return ids;
}

/// Gaps in blocks of 128, as many bits each as the largest of the block needs.
Bytes packedGaps(const Ids& ids) {
  Bytes bytes;
  uint32_t expected = 0;
  for (size_t first = 0; first < ids.size(); first += 128) {
    const size_t end = std::min(first + 128, ids.size());
    Ids gaps;
    uint32_t all = 0;
    for (size_t i = first; i < end; ++i) {
      gaps.push_back(ids[i] - expected);
      all |= gaps.back();
      expected = ids[i] + 1;
    }
    const auto bits = unsigned(std::bit_width(all));
    bytes.push_back(uint8_t(bits));
    uint64_t waiting = 0;
    unsigned filled = 0;
    for (uint32_t gap : gaps) {
      waiting |= uint64_t(gap) << filled;
      for (filled += bits; filled >= 8; filled -= 8, waiting >>= 8) bytes.push_back(uint8_t(waiting));
    }
    if (filled != 0) bytes.push_back(uint8_t(waiting));
  }
  return bytes;
}

Ids fromPackedGaps(const Bytes& bytes, size_t count) {
  Ids ids;
  uint32_t expected = 0;
  for (size_t at = 0; ids.size() < count;) {
    const unsigned bits = bytes[at++];
    uint64_t waiting = 0;
    unsigned filled = 0;
    for (size_t end = std::min(ids.size() + 128, count); ids.size() < end;) {
      for (; filled < bits; filled += 8) waiting |= uint64_t(bytes[at++]) << filled;
      expected += uint32_t(waiting & ((uint64_t(1) << bits) - 1));
      ids.push_back(expected++);
      waiting >>= bits;
      filled -= bits;
    }
  }
  return ids;
}

#ifdef SL_HAVE_ROARING
Bytes roaringBytes(const Ids& ids) {
  roaring_bitmap_t* set = roaring_bitmap_of_ptr(ids.size(), ids.data());
  roaring_bitmap_run_optimize(set);
  Bytes bytes(roaring_bitmap_portable_size_in_bytes(set));
  roaring_bitmap_portable_serialize(set, reinterpret_cast<char*>(bytes.data()));
  roaring_bitmap_free(set);
  return bytes;
}

Ids fromRoaring(const Bytes& bytes) {
  roaring_bitmap_t* set =
      roaring_bitmap_portable_deserialize_safe(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Ids ids(roaring_bitmap_get_cardinality(set));
  roaring_bitmap_to_uint32_array(set, ids.data());
  roaring_bitmap_free(set);
  return ids;
}
#endif

std::vector<Codec> codecs() {
  const auto unzip = [](const Bytes& frame) { return *decompress(frame, uint64_t(1) << 34); };
  std::vector<Codec> list;
  list.push_back({"runs, zstd 3 (the file's)", [](const Ids& ids) { return encodeSet(ids); },
                  [](const Bytes& b, size_t count) { return *decodeSet(b, count, 0xffffffffu); }});
  for (int level : {3, 19}) {
    list.push_back({fmt::format("gaps, zstd {}", level),
                    [level](const Ids& ids) { return zip(gapBytes(ids), level); },
                    [=](const Bytes& b, size_t) { return fromGapBytes(unzip(b)); }});
  }
  list.push_back({"bit-packed gaps, zstd 3", [](const Ids& ids) { return zip(packedGaps(ids), 3); },
                  [=](const Bytes& b, size_t count) { return fromPackedGaps(unzip(b), count); }});
#ifdef SL_HAVE_ROARING
  list.push_back({"CRoaring", roaringBytes, [](const Bytes& b, size_t) { return fromRoaring(b); }});
  list.push_back({"CRoaring, zstd 3", [](const Ids& ids) { return zip(roaringBytes(ids), 3); },
                  [=](const Bytes& b, size_t) { return fromRoaring(unzip(b)); }});
#endif
  return list;
}

void measure(const Ids& ids) {
  fmt::print(
      "| codec | bytes | bits an id | packed M ids/s | read M ids/s |\n| --- | --- | --- | --- | --- |\n");
  for (const Codec& codec : codecs()) {
    const Bytes bytes = codec.encode(ids);
    if (codec.decode(bytes, ids.size()) != ids) throw std::runtime_error(codec.name + " changed the set");
    const double encode = medianSeconds([&] { codec.encode(ids); });
    const double decode = medianSeconds([&] { codec.decode(bytes, ids.size()); });
    const double million = double(ids.size()) * 1e-6;
    fmt::print("| {} | {} | {:.2f} | {:.0f} | {:.0f} |\n", codec.name, bytes.size(),
               8.0 * double(bytes.size()) / double(ids.size()), million / encode, million / decode);
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using namespace sightline;
  try {
    for (int i = 1; i < argc; ++i) {
      const PvsFile pvs = loadPvs(argv[i]);
      for (const CellPvs& cell : pvs.cells) {
        fmt::print("\n{}, cell {}: {} of {} triangles\n\n", pvs.scene_name, cell.cell.name,
                   cell.triangles.size(), pvs.triangle_count);
        measure(cell.triangles);
      }
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_pvs: {}\n", error.what());
    return 1;
  }
  return argc > 1 ? 0 : 2;
}
