#include "core/cli/cell_warnings.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "core/base/text.h"

namespace sightline {
namespace {

/// Cells that get a line of their own.
constexpr size_t kMostSaid = 10;

std::string joined(std::span<const CellWarning> warnings) {
  std::string text;
  for (const CellWarning& warning : warnings) text += (text.empty() ? "" : "; it ") + warning.text;
  return text;
}

void sayLine(const std::string& line) {
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

void CellWarningPrinter::say(const std::string& cell, std::span<const CellWarning> warnings) {
  if (warnings.empty()) return;
  if (said_ == kMostSaid) {
    ++passed_over_;
    return;
  }
  ++said_;
  sayLine(fmt::format("warning: {} {}", cell, joined(warnings)));
}

void CellWarningPrinter::end() {
  if (passed_over_ == 0) return;
  sayLine(fmt::format("warning: {} more: see the table at the end, --report or --html",
                      counted(passed_over_, "cell")));
  passed_over_ = 0;
}

void refuseWarnedCells(std::span<const WarnedCell> cells) {
  std::string list;
  size_t count = 0;
  for (const auto& [name, warnings] : cells) {
    if (warnings.empty()) continue;
    ++count;
    list += (list.empty() ? "" : "; ") + name + " " + joined(warnings);
  }
  if (count == 0) return;
  throw Error(fmt::format("--strict-cells: {} cannot be taken: {}", counted(count, "cell"), list),
              kExitUsage);
}

}  // namespace sightline
