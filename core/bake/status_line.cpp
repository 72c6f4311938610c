#include "core/bake/status_line.h"

#include <cstdio>

#include "core/bake/progress.h"

namespace sightline {
namespace {

constexpr std::chrono::milliseconds kRewriteInterval{100}, kLineInterval{5000};

}  // namespace

void StatusLine::write(const std::string& line) {
  const bool terminal = terminalColumns(stdout) > 0;
  next_ = std::chrono::steady_clock::now() + (terminal ? kRewriteInterval : kLineInterval);
  std::fputs((terminal ? "\r" + line + "\x1b[K" : line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void StatusLine::end() {
  if (terminalColumns(stdout) == 0) return;
  std::fputs("\r\x1b[K", stdout);
  std::fflush(stdout);
}

}  // namespace sightline
