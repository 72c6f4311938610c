#pragma once
#include <fmt/format.h>

#include <atomic>
#include <functional>
#include <string>

#include "core/bake/status_line.h"
#include "core/base/interrupted.h"
#include "core/cli/commands.h"
#include "core/cli/stop_signal.h"

namespace sightline {

/// Placing of cells that ends in order with Ctrl-C, and shows how far it is.
class WatchedPlacing {
 public:
  const std::atomic<bool>* flag() const { return stop_.flag(); }

  /// Shows the line that makeLine() returns.
  template <typename MakeLine>
  void show(MakeLine&& makeLine) {
    status_.show(makeLine);
  }
  /// Shows "what: 42 %".
  std::function<void(double)> progress(const std::string& what) {
    return [this, what](double done) { show([&] { return fmt::format("{}: {:.0f} %", what, 100 * done); }); };
  }

  /// What work() returns. Throws ExitCode if it was stopped.
  template <typename Work>
  auto run(Work&& work) {
    try {
      auto result = work();
      status_.end();
      return result;
    } catch (const Interrupted&) {
      status_.end();
      fmt::print("stopped: no cells are written\n");
      throw ExitCode{stop_.exitCode()};
    } catch (...) {
      status_.end();
      throw;
    }
  }

 private:
  StopSignal stop_;
  StatusLine status_;
};

}  // namespace sightline
