#include "core/report/status_line.h"

#include "core/report/progress.h"

namespace sightline {
namespace {

constexpr std::chrono::milliseconds kTerminalInterval{100}, kPlainInterval{5000};

}  // namespace

void StatusLine::write(const std::string& line) {
  const bool terminal = terminalColumns(out_) > 0;
  next_ = std::chrono::steady_clock::now() + (terminal ? kTerminalInterval : kPlainInterval);
  std::fputs((terminal ? "\r" + line + "\x1b[K" : line + "\n").c_str(), out_);
  std::fflush(out_);
}

void StatusLine::end() {
  if (terminalColumns(out_) == 0) return;
  std::fputs("\r\x1b[K", out_);
  std::fflush(out_);
}

}  // namespace sightline
