#include "core/report/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

/// Characters of UTF-8 text, so that names with accents do not break the columns.
size_t width(const std::string& text) {
  return size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, size_t columns) {
  return text + std::string(columns - std::min(columns, width(text)), ' ');
}

std::string missingText(const CellSummary& cell) {
  if (cell.stats.validation_rays == 0) return "not measured";
  return fmt::format("{:.2g} (< {:.2g})", cell.missingShare(), cell.missingBound());
}

}  // namespace

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

std::string stageName(uint32_t stage) {
  constexpr const char* kNames[] = {"random", "border", "reverse", "contained"};
  return stage < 4 ? kNames[stage] : "unknown";
}

std::string hashText(uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

std::string verdictNames(std::span<const CellWarning> warnings) {
  std::string names;
  for (const CellWarning& warning : warnings) {
    names += (names.empty() ? "" : ", ") + std::string(verdictName(warning.verdict));
  }
  return names;
}

std::string cellTable(std::span<const CellSummary> cells, uint32_t triangle_count,
                      std::span<const std::vector<CellWarning>> warnings) {
  size_t name_width = 4;
  for (const CellSummary& cell : cells) name_width = std::max(name_width, width(cell.cell.name));
  std::string table = padded("cell", name_width) +
                      "   triangles    share      rays  Mrays/s  iterations  missing rays (95 %)   seconds\n";
  for (size_t i = 0; i < cells.size(); ++i) {
    const CellSummary& cell = cells[i];
    const double share = triangle_count == 0 ? 0 : 100.0 * cell.pvs_size / triangle_count;
    table += padded(cell.cell.name, name_width);
    table += fmt::format("  {:>10}  {:>5.2f} %  {:>8}  {:>7.2f}  {:>10}  {:>19}  {:>8.1f}", cell.pvs_size,
                         share, shortCount(cell.rays()), cell.mraysPerSecond(), cell.stats.iterations,
                         missingText(cell), cell.stats.seconds);
    if (cell.stats.bound_tests > 0) table += fmt::format("  error < {:.3g} (95 %)", cell.stats.error_bound);
    if (cell.stats.stop != StopReason::kConverged) table += "  " + stopReasonName(cell.stats.stop);
    if (i < warnings.size() && !warnings[i].empty()) table += "  warning: " + verdictNames(warnings[i]);
    table += '\n';
  }
  return table;
}

}  // namespace sightline
