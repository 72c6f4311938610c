#pragma once
// Checks of numbers on the command line where CLI11's own are not enough.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <string>

#include "core/cli/whole_number.h"

namespace sightline {

/// CLI11's own range shows its limits as 4.29497e+09 and lets "nan" pass.
inline CLI::Validator between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("{} is not a number from {} to {}", text, low, high);
      },
      "");
}

/// 1e18 rather than 1000000000000000000; other numbers in full.
inline std::string limitText(uint64_t limit) {
  constexpr uint64_t kLongest = 1'000'000'000'000;
  uint64_t rest = limit;
  int zeros = 0;
  for (; rest >= 10 && rest % 10 == 0; rest /= 10) ++zeros;
  return limit < kLongest || rest > 9 ? std::to_string(limit) : fmt::format("{}e{}", rest, zeros);
}

/// A count (parseCount), which it turns into plain digits: give it to transform(), not to check().
inline CLI::Validator wholeNumber(uint64_t low = 0, uint64_t high = std::numeric_limits<uint64_t>::max()) {
  return CLI::Validator(
      [low, high](std::string& text) {
        const auto value = parseCount(text);
        if (!value || *value < low || *value > high) {
          return fmt::format("{} is not a whole number from {} to {}", text, limitText(low), limitText(high));
        }
        text = std::to_string(*value);
        return std::string();
      },
      "");
}

/// Bytes (parseBytes), which it turns into plain digits: give it to transform(), not to check().
inline CLI::Validator byteSize() {
  return CLI::Validator(
      [](std::string& text) {
        const auto value = parseBytes(text);
        if (!value) {
          return fmt::format("{} is not a whole number of bytes, such as 4000000000, 4GB or 3.7GiB", text);
        }
        text = std::to_string(*value);
        return std::string();
      },
      "");
}

}  // namespace sightline
