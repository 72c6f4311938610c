#include "core/formats/utf16.h"

namespace sightline {
namespace {

/// Most bytes that two bytes of UTF-16 become.
constexpr size_t kBytesAUnit = 3;
constexpr uint32_t kReplacement = 0xfffd;

class Utf8Writer {
 public:
  explicit Utf8Writer(size_t most_bytes) : bytes_{std::make_unique<char[]>(most_bytes), 0} {}

  void add(uint32_t code) {
    if (code < 0x80) return put(code);
    if (code < 0x800) {
      put(0xc0 | code >> 6);
    } else if (code < 0x10000) {
      put(0xe0 | code >> 12);
      put(0x80 | (code >> 6 & 0x3f));
    } else {
      put(0xf0 | code >> 18);
      put(0x80 | (code >> 12 & 0x3f));
      put(0x80 | (code >> 6 & 0x3f));
    }
    put(0x80 | (code & 0x3f));
  }

  FileBytes take() { return std::move(bytes_); }

 private:
  void put(uint32_t byte) { bytes_.data[bytes_.size++] = char(byte); }

  FileBytes bytes_;
};

}  // namespace

std::optional<FileBytes> fromUtf16(std::string_view bytes) {
  const bool little = bytes.starts_with("\xff\xfe");
  if (!little && !bytes.starts_with("\xfe\xff")) return std::nullopt;
  const size_t units = (bytes.size() + 1) / 2;
  const auto byte = [&](size_t i) { return i < bytes.size() ? uint32_t(uint8_t(bytes[i])) : 0u; };
  const auto unit = [&](size_t i) {
    if (2 * i + 1 >= bytes.size()) return kReplacement;
    return little ? byte(2 * i) | byte(2 * i + 1) << 8 : byte(2 * i) << 8 | byte(2 * i + 1);
  };
  Utf8Writer text(kBytesAUnit * units);
  for (size_t i = 1; i < units; ++i) {
    const uint32_t first = unit(i);
    if (first < 0xd800 || first > 0xdfff) {
      text.add(first);
      continue;
    }
    const uint32_t second = i + 1 < units ? unit(i + 1) : 0;
    if (first > 0xdbff || second < 0xdc00 || second > 0xdfff) {
      text.add(kReplacement);
      continue;
    }
    text.add(0x10000 + ((first - 0xd800) << 10) + (second - 0xdc00));
    ++i;
  }
  return text.take();
}

}  // namespace sightline
