#include "core/base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sightline {

std::string shortCount(uint64_t count) {
  if (count < 1000) return std::to_string(count);
  double value = double(count) / 1000;
  const char* unit = "kMGTPE";
  while (value >= 999.5 && unit[1] != 0) value /= 1000, ++unit;
  const int decimals = value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}{}", value, decimals, *unit);
}

std::string counted(uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string shortDuration(double seconds) {
  if (!(seconds >= 0) || seconds > 1e9) return "?";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = uint64_t(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string hashText(uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

size_t textWidth(std::string_view text) {
  return size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace sightline
