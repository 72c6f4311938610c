#pragma once
// Whole numbers as people write them and as the program prints them: 250000, 250k, 12.3M, 1e6; bytes as
// 4GB, 1.5 GiB.
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace sightline {

/// digits * 10^exponent.
struct ExactDecimal {
  uint64_t digits = 0;
  int64_t exponent = 0;
};

/// Takes digits, perhaps with a point among them and an exponent after them, from the beginning of the text.
/// None: it begins with something else, or has more digits than 64 bits hold, not counting zeros at either
/// end.
inline std::optional<ExactDecimal> takeExactDecimal(std::string_view& text) {
  std::string digits;
  ExactDecimal decimal;
  bool point = false;
  size_t at = 0;
  for (; at < text.size(); ++at) {
    const bool digit = text[at] >= '0' && text[at] <= '9';
    if (!digit && (text[at] != '.' || point || at == 0)) break;
    if (digit) digits += text[at];
    if (digit && point) --decimal.exponent;
    point = point || !digit;
  }
  if (at == 0 || text[at - 1] == '.') return std::nullopt;
  // An E that no digit follows is a unit.
  const size_t power = at + 1 < text.size() && (text[at] == 'e' || text[at] == 'E') ? at + 1 : text.size();
  const size_t first = power < text.size() && text[power] == '+' ? power + 1 : power;
  int value = 0;
  const auto [end, failure] = std::from_chars(text.data() + first, text.data() + text.size(), value);
  if (failure == std::errc::result_out_of_range || (first > power && value < 0)) return std::nullopt;
  if (failure == std::errc()) {
    decimal.exponent += value;
    at = size_t(end - text.data());
  }
  for (; digits.size() > 1 && digits.back() == '0'; ++decimal.exponent) digits.pop_back();
  text.remove_prefix(at);
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), decimal.digits);
  if (parsed.ec != std::errc()) return std::nullopt;
  return decimal;
}

/// decimal * unit (at most 2^60). None: more than 64 bits, or not whole and not to be rounded down.
inline std::optional<uint64_t> timesUnit(ExactDecimal decimal, uint64_t unit, bool round_down) {
  constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
  unsigned __int128 value = static_cast<unsigned __int128>(decimal.digits) * unit;
  for (; decimal.exponent > 0 && value != 0 && value <= kMost; --decimal.exponent) value *= 10;
  for (; decimal.exponent < 0 && value != 0; ++decimal.exponent) {
    if (value % 10 != 0 && !round_down) return std::nullopt;
    value /= 10;
  }
  if (value > kMost || (value == 0 && decimal.digits != 0)) return std::nullopt;
  return static_cast<uint64_t>(value);
}

/// 1 to 6 for k, M, G, T, P and E, large or small; 0: another letter.
inline int thousandsOf(char letter) {
  constexpr std::string_view kLetters = "kmgtpe";
  const char small = letter >= 'A' && letter <= 'Z' ? char(letter - 'A' + 'a') : letter;
  return int(kLetters.find(small) + 1);  // npos + 1 is 0
}

/// A count: a decimal number that is whole, perhaps with k, M, G, T, P or E (10^3 to 10^18) after it. None:
/// anything else, such as -5, 1.5, 1e400 or nan.
inline std::optional<uint64_t> parseCount(std::string_view text) {
  const auto decimal = takeExactDecimal(text);
  if (!decimal || text.size() > 1) return std::nullopt;
  const int thousands = text.empty() ? 0 : thousandsOf(text[0]);
  if (!text.empty() && thousands == 0) return std::nullopt;
  uint64_t unit = 1;
  for (int i = 0; i < thousands; ++i) unit *= 1000;
  return timesUnit(*decimal, unit, false);
}

/// Bytes: the same, and with B after it; kB, MB, GB ... are powers of 1000, KiB, MiB, GiB ... (or Ki, Mi, Gi)
/// powers of 1024, of which a fraction of a byte is left out. A blank may stand before the unit.
inline std::optional<uint64_t> parseBytes(std::string_view text) {
  const auto decimal = takeExactDecimal(text);
  if (!decimal) return std::nullopt;
  const auto takes = [&text](std::string_view either) {
    const bool found = !text.empty() && either.find(text[0]) != std::string_view::npos;
    if (found) text.remove_prefix(1);
    return found;
  };
  if (text.size() > 1) takes(" ");
  const int thousands = text.empty() ? 0 : thousandsOf(text[0]);
  if (thousands > 0) text.remove_prefix(1);
  const bool binary = thousands > 0 && takes("iI");
  takes("bB");
  if (!text.empty()) return std::nullopt;
  uint64_t unit = 1;
  for (int i = 0; i < thousands; ++i) unit *= binary ? 1024 : 1000;
  return timesUnit(*decimal, unit, binary);
}

}  // namespace sightline
