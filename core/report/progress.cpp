#include "core/report/progress.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/report/text.h"

namespace sightline {
namespace {

/// Seconds between two changes of the line on a terminal: calm for the eye, no cost.
constexpr double kTerminalInterval = 0.1;
/// Seconds between two plain lines of a cell: a log of an hour stays readable.
constexpr double kPlainInterval = 5;
/// Columns when a terminal does not say.
constexpr uint32_t kUsualColumns = 80;

/// At most `columns` characters of UTF-8 text.
std::string cut(const std::string& text, uint32_t columns) {
  uint32_t shown = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if ((text[i] & 0xc0) != 0x80 && shown++ == columns) return text.substr(0, i);
  }
  return text;
}

std::string place(const std::string& name, uint32_t index, size_t cells) {
  return fmt::format("{} {}/{}", name, index + 1, cells);
}

}  // namespace

uint32_t terminalColumns(std::FILE* out) {
  if (!::isatty(::fileno(out))) return 0;
  winsize size = {};
  if (::ioctl(::fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualColumns;
  return size.ws_col;
}

std::string progressLine(const std::string& name, uint32_t index, size_t cells, const BakeProgress& progress,
                         double all_seconds_left) {
  const double rate = progress.seconds > 0 ? double(progress.rays) / progress.seconds * 1e-6 : 0;
  return fmt::format("{}  iteration {}, {}  {} rays  {:.2f} Mrays/s  PVS {} (+{})  left {}, all {}",
                     place(name, index, cells), progress.iteration,
                     progress.validating ? "validation" : stageName(progress.stage),
                     shortCount(progress.rays), rate, progress.pvs_size, progress.new_triangles,
                     shortDuration(progress.seconds_left), shortDuration(all_seconds_left));
}

std::string doneLine(uint32_t index, size_t cells, const CellSummary& cell) {
  return fmt::format("{}  done: PVS {}  {} rays  {:.2f} Mrays/s  {} iterations  {}",
                     place(cell.cell.name, index, cells), cell.pvs_size, shortCount(cell.rays()),
                     cell.mraysPerSecond(), cell.stats.iterations, shortDuration(cell.stats.seconds));
}

ProgressPrinter::ProgressPrinter(std::FILE* out, uint32_t columns, std::vector<ViewCell> planned,
                                 std::span<const CellSummary> finished)
    : out_(out), columns_(columns), planned_(std::move(planned)) {
  for (const CellSummary& cell : finished) {
    finished_seconds_ += cell.stats.seconds;
    ++finished_cells_;
  }
}

double ProgressPrinter::secondsLeft(uint32_t index, const BakeProgress& progress) const {
  // Cells to come are taken to last as long as the mean of those known, this one by its estimate.
  const double mean =
      (finished_seconds_ + progress.seconds + progress.seconds_left) / double(finished_cells_ + 1);
  return progress.seconds_left + mean * double(planned_.size() - index - 1);
}

void ProgressPrinter::show(const std::string& line, bool last) {
  std::string text;
  if (columns_ == 0) {
    text = line + "\n";
  } else {
    // One column stays free: some terminals wrap when the last one is filled.
    text = fmt::format("\r{}\x1b[K{}", cut(line, std::max(columns_, 2u) - 1), last ? "\n" : "");
    line_open_ = !last;
  }
  std::fputs(text.c_str(), out_);  // not fmt::print: a closed pipe must not throw
  std::fflush(out_);
}

void ProgressPrinter::progress(uint32_t index, const BakeProgress& progress) {
  const bool new_cell = index != shown_cell_;
  const double interval = columns_ == 0 ? kPlainInterval : kTerminalInterval;
  if (!new_cell && progress.seconds < shown_seconds_ + interval) return;
  shown_cell_ = index;
  shown_seconds_ = progress.seconds;
  show(progressLine(planned_[index].name, index, planned_.size(), progress, secondsLeft(index, progress)),
       false);
}

void ProgressPrinter::cellDone(uint32_t index, const CellSummary& cell) {
  finished_seconds_ += cell.stats.seconds;
  ++finished_cells_;
  show(doneLine(index, planned_.size(), cell), true);
}

void ProgressPrinter::breakLine() {
  if (!line_open_) return;
  std::fputs("\n", out_);
  line_open_ = false;
}

}  // namespace sightline
