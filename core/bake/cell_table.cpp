#include "core/bake/cell_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/text.h"

namespace sightline {
namespace {

std::string padded(const std::string& text, size_t columns) {
  return text + std::string(columns - std::min(columns, textWidth(text)), ' ');
}

std::string missingText(const CellSummary& cell) {
  if (cell.stats.validation_rays == 0) return "not measured";
  return fmt::format("{:.2g} (< {:.2g})", cell.missingShare(), cell.missingBound());
}

}  // namespace

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
  for (const CellSummary& cell : cells) name_width = std::max(name_width, textWidth(cell.cell.name));
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
