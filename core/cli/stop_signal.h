#pragma once
#include <atomic>

namespace sightline {

/// While it lives, the first SIGINT or SIGTERM only sets a flag, so that the work can end in order; a second
/// one ends the program. One at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  const std::atomic<bool>* flag() const;
  /// 130 after SIGINT, 143 after SIGTERM (128 + signal, as shells have it); 0 before.
  int exitCode() const;
};

}  // namespace sightline
