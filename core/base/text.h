#pragma once
#include <cstdint>
#include <string>
#include <string_view>

// Numbers for people.
namespace sightline {

/// 950, 12.3k, 4.56M, 7.89G: three digits.
std::string shortCount(uint64_t count);
/// "1 cell", "2 cells": the noun takes an s unless there is one.
std::string counted(uint64_t count, const std::string& noun);
/// 0.4 s, 12 s, 3 min 05 s, 2 h 07 min. Unknown (negative or not finite): "?".
std::string shortDuration(double seconds);

/// 16 hexadecimal digits.
std::string hashText(uint64_t hash);

/// Characters of UTF-8 text, so that names with accents do not break columns.
size_t textWidth(std::string_view text);

}  // namespace sightline
