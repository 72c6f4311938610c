#include "core/bake/progress.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/pvs/stage_name.h"

namespace sightline {
namespace {

/// Seconds between two changes of the line on a terminal: calm for the eye, no cost.
constexpr double kTerminalInterval = 0.1;
/// Seconds between two plain lines of a cell: a log of an hour stays readable.
constexpr double kPlainInterval = 5;
/// Columns when a terminal does not say.
constexpr uint32_t kUsualColumns = 80;
/// A name is not cut below so many characters.
constexpr size_t kShortestName = 3;

/// At most `columns` characters of UTF-8 text.
std::string cut(const std::string& text, uint32_t columns) {
  uint32_t shown = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if ((text[i] & 0xc0) != 0x80 && shown++ == columns) return text.substr(0, i);
  }
  return text;
}

/// The line with single instead of double blanks, and with a shorter name if that is not enough.
std::string tighten(std::string line, const std::string& name, uint32_t columns) {
  for (size_t at = line.find("  ", name.size()); at != std::string::npos; at = line.find("  ", at)) {
    line.erase(at, 1);
  }
  const size_t excess = textWidth(line) - std::min<size_t>(textWidth(line), columns);
  const size_t name_width = textWidth(name);
  if (excess == 0 || name_width <= kShortestName) return line;
  const size_t kept = std::max(kShortestName, name_width - std::min(name_width, excess + 1));
  return cut(name, uint32_t(kept)) + "~" + line.substr(name.size());
}

/// Makes the line fit: tightens it, then leaves out its last fields, which double blanks part: a number cut
/// in two would be another one. The name is the line's beginning.
std::string fit(std::string line, const std::string& name, uint32_t columns) {
  if (textWidth(line) <= columns) return line;
  for (;;) {
    const std::string text = tighten(line, name, columns);
    const size_t last = line.rfind("  ");
    if (textWidth(text) <= columns || last == std::string::npos || last < name.size())
      return cut(text, columns);
    line.erase(last);
  }
}

std::string place(const std::string& name, uint32_t index, size_t cells) {
  return fmt::format("{} {}/{}", name, index + 1, cells);
}

/// 0:10, 3:05, 2:07:00.
std::string clock(double seconds) {
  if (!(seconds >= 0) || seconds > 1e9) return "?";
  const auto whole = uint64_t(std::llround(seconds));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole % 3600 / 60, whole % 60);
}

/// 0:10; >0:10 for at least so much; 0:05-0:40 for a range. after: what follows the cell, in seconds.
std::string timeLeft(const BakeProgress& progress, double after) {
  const std::string likely = clock(progress.seconds_left + after);
  if (progress.seconds_left < 0 || likely == "?") return "?";
  if (progress.at_least) return ">" + likely;
  if (progress.seconds_left_to <= 0) return likely;
  const std::string from = clock(progress.seconds_left_from + after);
  const std::string to = clock(progress.seconds_left_to + after);
  return from == to ? from : from + "-" + to;
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
  const std::string stage = progress.testing      ? "error test"
                            : progress.validating ? "validation"
                                                  : stageName(progress.stage);
  return fmt::format("{}  it {} {}  {} rays  PVS {} +{}  left {}, all {}  {:.2f} Mrays/s",
                     place(name, index, cells), progress.iteration, stage, shortCount(progress.rays),
                     progress.pvs_size, progress.new_triangles, timeLeft(progress, 0),
                     progress.seconds_left < 0 ? clock(all_seconds_left)
                                               : timeLeft(progress, all_seconds_left - progress.seconds_left),
                     rate);
}

std::string doneLine(uint32_t index, size_t cells, const CellSummary& cell) {
  return fmt::format("{}  done: PVS {}  {} rays  {:.2f} Mrays/s  {}  {}", place(cell.cell.name, index, cells),
                     cell.pvs_size, shortCount(cell.rays()), cell.mraysPerSecond(),
                     counted(cell.stats.iterations, "iteration"), shortDuration(cell.stats.seconds));
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
  if (progress.seconds_left < 0) {
    if (finished_cells_ == 0) return -1;
    const double mean = finished_seconds_ / double(finished_cells_);
    return std::max(0.0, mean - progress.seconds) + mean * double(planned_.size() - index - 1);
  }
  const double mean =
      (finished_seconds_ + progress.seconds + progress.seconds_left) / double(finished_cells_ + 1);
  return progress.seconds_left + mean * double(planned_.size() - index - 1);
}

void ProgressPrinter::show(const std::string& line, const std::string& name, bool last) {
  std::string text;
  if (columns_ == 0) {
    text = line + "\n";
  } else {
    // One column stays free: some terminals wrap when the last one is filled.
    text = fmt::format("\r{}\x1b[K{}", fit(line, name, std::max(columns_, 2u) - 1), last ? "\n" : "");
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
       planned_[index].name, false);
}

void ProgressPrinter::cellDone(uint32_t index, const CellSummary& cell) {
  finished_seconds_ += cell.stats.seconds;
  ++finished_cells_;
  show(doneLine(index, planned_.size(), cell), cell.cell.name, true);
}

void ProgressPrinter::breakLine() {
  if (!line_open_) return;
  std::fputs("\n", out_);
  line_open_ = false;
}

}  // namespace sightline
