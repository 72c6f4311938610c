#include "core/io/decimal.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace sightline {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// What Microsoft's runtimes print behind "1." for numbers that are none, as in "1.#QNAN0": its value, cut
/// off the text; nothing where it does not start so.
std::optional<double> takeNoNumber(std::string_view& text) {
  for (const std::string_view word : {"#QNAN", "#SNAN", "#IND", "#INF", "#NAN"}) {
    if (!text.starts_with(word)) continue;
    text.remove_prefix(std::min(text.find_first_not_of("0123456789", word.size()), text.size()));
    return word == "#INF" ? HUGE_VAL : double(NAN);
  }
  return std::nullopt;
}

/// A number beyond double: std::from_chars does not tell which end was passed.
double outOfRange(std::string_view number) {
  const double sign = number[0] == '-' ? -1.0 : 1.0;
  const size_t exponent = number.find_first_of("eE");
  const bool small =
      exponent != std::string_view::npos && exponent + 1 < number.size() && number[exponent + 1] == '-';
  return small ? sign * 0.0 : sign * HUGE_VAL;
}

/// Whether rounding the double to float may give another number than rounding the text itself: it lies in the
/// middle between two floats, where the digits that the double lost decide, or below the normal floats, where
/// the middle is elsewhere.
bool needsText(double value) {
  constexpr uint64_t kBelowFloat = (1ull << 29) - 1;  // bits of a double that a float has not
  constexpr uint64_t kMiddle = 1ull << 28;
  return (std::bit_cast<uint64_t>(value) & kBelowFloat) == kMiddle ||
         (value != 0.0 && std::fabs(value) < double(FLT_MIN));
}

}  // namespace

std::optional<Decimal> takeDecimal(std::string_view& text) {
  size_t begin = 0;
  while (begin < text.size() && isBlank(text[begin])) ++begin;
  if (begin + 1 < text.size() && text[begin] == '+' && text[begin + 1] != '-') ++begin;
  const char* first = text.data() + begin;
  const char* last = text.data() + text.size();
  Decimal value;
  const auto result = std::from_chars(first, last, value.full);
  if (result.ec == std::errc::invalid_argument) return std::nullopt;
  std::string_view rest(result.ptr, size_t(last - result.ptr));
  const auto no_number = takeNoNumber(rest);
  if (!rest.empty() && !isBlank(rest.front())) return std::nullopt;
  if (no_number) {
    text = rest;
    return Decimal{float(*no_number), *no_number};
  }
  if (result.ec == std::errc::result_out_of_range) {
    value.full = outOfRange({first, size_t(result.ptr - first)});
  }
  value.single = float(value.full);
  if (needsText(value.full)) std::from_chars(first, last, value.single);  // unchanged if out of range
  text = rest;
  return value;
}

}  // namespace sightline
