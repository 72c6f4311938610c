#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/cell_check.h"

namespace sightline {

/// Says what is wrong with cells on standard output, a line a cell; of many cells, the first few.
class CellWarningPrinter {
 public:
  /// Nothing is said where there are no warnings.
  void say(const std::string& cell, std::span<const CellWarning> warnings);
  /// How many cells were passed over since the last call, in a line; nothing if there were none.
  void end();

 private:
  size_t said_ = 0, passed_over_ = 0;
};

/// A cell's name, and what is wrong with it.
using WarnedCell = std::pair<std::string, std::vector<CellWarning>>;

/// For --strict-cells: throws Error (exit code 2) that names each cell that has warnings, with all of them.
void refuseWarnedCells(std::span<const WarnedCell> cells);

}  // namespace sightline
