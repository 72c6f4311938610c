#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sightline {

using Bytes = std::vector<uint8_t>;

/// Appends numbers, little endian and without padding.
class ByteWriter {
 public:
  template <typename T>
  void number(T value) {
    static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
    const auto* first = reinterpret_cast<const uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }
  /// Length (uint32) and characters.
  void text(std::string_view value) {
    number(uint32_t(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  void raw(std::span<const uint8_t> value) {
    bytes_.reserve(bytes_.size() + value.size());  // else GCC 12 sees a copy out of bounds here, wrongly
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// Reads what ByteWriter wrote. Past the end it delivers zeros and remembers the failure, so that a reader
/// can check once, before it uses a size.
class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  T number() {
    T value{};
    const auto source = raw(sizeof(T));
    if (source.size() == sizeof(T)) std::memcpy(&value, source.data(), sizeof(T));
    return value;
  }
  std::string text() {
    const auto source = raw(number<uint32_t>());
    return std::string(source.begin(), source.end());
  }
  /// The next `size` bytes; empty and failed if there are fewer.
  std::span<const uint8_t> raw(uint64_t size) {
    if (failed_ || size > bytes_.size()) {
      failed_ = true;
      return {};
    }
    const auto result = bytes_.first(size_t(size));
    bytes_ = bytes_.subspan(size_t(size));
    return result;
  }
  size_t left() const { return bytes_.size(); }
  bool failed() const { return failed_; }
  /// Everything was read, and nothing was missing.
  bool finished() const { return !failed_ && bytes_.empty(); }

 private:
  std::span<const uint8_t> bytes_;
  bool failed_ = false;
};

}  // namespace sightline
