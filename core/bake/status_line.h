#pragma once
#include <chrono>
#include <string>

namespace sightline {

/// A line on standard output that says how far long work has come: rewritten in place on a terminal; else a
/// plain line every few seconds.
class StatusLine {
 public:
  /// Shows what makeLine() returns, unless a line was shown only just now. The first second is silent.
  template <typename MakeLine>
  void show(MakeLine&& makeLine) {
    if (std::chrono::steady_clock::now() >= next_) write(makeLine());
  }
  /// Wipes the line away, so that others can follow.
  void end();

 private:
  void write(const std::string& line);

  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + std::chrono::seconds(1);
};

}  // namespace sightline
