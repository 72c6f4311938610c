#include "core/scene/decimal.h"

#include <charconv>
#include <cmath>
#include <limits>

namespace sightline {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// Sign and magnitude of a number beyond float: std::from_chars does not tell which end was passed.
float outOfRange(std::string_view number) {
  double value = 0.0;
  const auto result = std::from_chars(number.data(), number.data() + number.size(), value);
  const float sign = number[0] == '-' ? -1.0f : 1.0f;
  if (result.ec == std::errc()) return std::fabs(value) < 1.0 ? sign * 0.0f : sign * HUGE_VALF;
  const size_t exponent = number.find_first_of("eE");
  const bool small =
      exponent != std::string_view::npos && exponent + 1 < number.size() && number[exponent + 1] == '-';
  return small ? sign * 0.0f : sign * HUGE_VALF;
}

}  // namespace

std::optional<float> takeFloat(std::string_view& text) {
  size_t begin = 0;
  while (begin < text.size() && isBlank(text[begin])) ++begin;
  if (begin + 1 < text.size() && text[begin] == '+' && text[begin + 1] != '-') ++begin;
  const char* first = text.data() + begin;
  const char* last = text.data() + text.size();
  float value = 0.0f;
  const auto result = std::from_chars(first, last, value);
  if (result.ec == std::errc::invalid_argument) return std::nullopt;
  if (result.ptr != last && !isBlank(*result.ptr)) return std::nullopt;
  if (result.ec == std::errc::result_out_of_range) value = outOfRange({first, size_t(result.ptr - first)});
  text.remove_prefix(size_t(result.ptr - text.data()));
  return value;
}

}  // namespace sightline
