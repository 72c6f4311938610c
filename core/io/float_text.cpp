#include "core/io/float_text.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>

#include "core/io/decimal.h"

namespace sightline {
namespace {

constexpr size_t kBitsDigits = 8;

std::optional<float> readHexFloat(std::string_view digits, bool negative) {
  if (digits.starts_with('-')) return std::nullopt;
  float value = 0;
  const auto [end, failure] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::hex);
  if (failure != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return negative ? -value : value;
}

std::optional<float> readBits(std::string_view digits) {
  uint32_t bits = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
  if (digits.size() != kBitsDigits || failure != std::errc() || end != digits.data() + digits.size()) {
    return std::nullopt;
  }
  return std::bit_cast<float>(bits);
}

}  // namespace

std::string hexFloat(float value) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  if (value == 0) return std::signbit(value) ? "-0x0p+0" : "0x0p+0";
  std::string text = fmt::format("{:a}", value);
  if (text.find("0x") == std::string::npos) text.insert(text[0] == '-' ? 1 : 0, "0x");
  return text;
}

std::string bitsText(float value) {
  return fmt::format("0x{:08x}", std::bit_cast<uint32_t>(value));
}

std::string bitsText(const glm::vec3& v) {
  return bitsText(v.x) + "," + bitsText(v.y) + "," + bitsText(v.z);
}

std::optional<float> readFloat(std::string_view text) {
  const bool negative = text.starts_with('-');
  const std::string_view size = text.substr(negative ? 1 : 0);
  if (size.starts_with("0x") || size.starts_with("0X")) {
    const std::string_view digits = size.substr(2);
    if (digits.find_first_of("pP") != std::string_view::npos) return readHexFloat(digits, negative);
    return negative ? std::nullopt : readBits(digits);
  }
  const auto value = takeDecimal(text);
  return value && text.empty() ? std::optional(value->single) : std::nullopt;
}

std::optional<glm::vec3> readVector(std::string_view text) {
  glm::vec3 v(0);
  for (int axis = 0; axis < 3; ++axis) {
    const size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (axis == 2)) return std::nullopt;
    const auto value = readFloat(text.substr(0, comma));
    if (!value) return std::nullopt;
    v[axis] = *value;
    text.remove_prefix(axis == 2 ? text.size() : comma + 1);
  }
  return v;
}

}  // namespace sightline
