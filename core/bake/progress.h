#pragma once
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "core/gvs/bake_cell.h"
#include "core/pvs/cell_summary.h"

namespace sightline {

/// Shows a bake while it runs. On a terminal one line a cell, rewritten in place; else plain lines: at the
/// start of a cell, at most one every few seconds, and at its end.
class ProgressPrinter {
 public:
  /// finished: cells of an earlier run, which count for the time left. columns: 0 = not a terminal.
  ProgressPrinter(std::FILE* out, uint32_t columns, std::vector<ViewCell> planned,
                  std::span<const CellSummary> finished = {});

  void progress(uint32_t index, const BakeProgress& progress);
  void cellDone(uint32_t index, const CellSummary& cell);
  /// Leaves the line in work as it stands and goes to the next.
  void breakLine();

 private:
  void show(const std::string& line, const std::string& name, bool last);
  double secondsLeft(uint32_t index, const BakeProgress& progress) const;

  std::FILE* out_;
  uint32_t columns_;
  std::vector<ViewCell> planned_;
  double finished_seconds_ = 0;
  uint32_t finished_cells_ = 0;
  uint32_t shown_cell_ = 0xffffffffu;  ///< whose line was shown last
  double shown_seconds_ = 0;           ///< of that cell
  bool line_open_ = false;
};

/// Columns of the terminal that `out` is; 0 if it is none.
uint32_t terminalColumns(std::FILE* out);

/// "street-1 2/10  it 3 border  12.3M rays  8.12 Mrays/s  PVS 12345 +17  left 0:12, all 3:10": iteration and
/// stage in work, size of the set and what this iteration added, time left for the cell and for all: ">0:12"
/// is at least so much, "0:05-0:40" a range in which it ends four times of five.
std::string progressLine(const std::string& name, uint32_t index, size_t cells, const BakeProgress& progress,
                         double all_seconds_left);
/// The same place's line when the cell is done.
std::string doneLine(uint32_t index, size_t cells, const CellSummary& cell);

}  // namespace sightline
