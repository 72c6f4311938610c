#pragma once
// Checks of numbers on the command line where CLI11's own are not enough.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <string>

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

/// Digits, and a unit after them if there is one: CLI11 lets -5 wrap around, and takes a unit for 0.
inline CLI::Validator byteSize() {
  return CLI::Validator(
      [](std::string& text) {
        const size_t unit = text.find_first_not_of("0123456789");
        const bool letters = unit == std::string::npos ||
                             text.find_first_not_of(" abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ",
                                                    unit) == std::string::npos;
        if (unit != 0 && letters) return std::string();
        return fmt::format("{} is not a whole number of bytes, such as 4000000000 or 4GB", text);
      },
      "");
}

/// Digits of a number that fits 64 bits: CLI11 lets -1 wrap around, and takes more than fits for 0.
inline CLI::Validator wholeNumber() {
  return CLI::Validator(
      [](std::string& text) {
        uint64_t value = 0;
        const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (failure == std::errc() && end == text.data() + text.size()) return std::string();
        return fmt::format("{} is not a whole number from 0 to 18446744073709551615", text);
      },
      "");
}

}  // namespace sightline
