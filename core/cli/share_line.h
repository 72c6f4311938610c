#pragma once
#include <fmt/core.h>

#include <chrono>
#include <string>

#include "core/bake/status_line.h"
#include "core/base/text.h"

namespace sightline {

/// A status line for work that knows which share of it is done: "42 % voxelised, 12.3M voxels, 12 s left".
class ShareLine {
 public:
  explicit ShareLine(std::string what) : what_(std::move(what)) {}
  /// done: 0 to 1; makeDetail() gives what stands after the share.
  template <typename MakeDetail>
  void show(double done, MakeDetail&& makeDetail) {
    line_.show([&] {
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
      const std::string left = done > 0 ? shortDuration(seconds * (1 - done) / done) : "?";
      return fmt::format("{:.0f} % {}, {}, {} left", 100 * done, what_, makeDetail(), left);
    });
  }
  void end() { line_.end(); }

 private:
  std::string what_;
  StatusLine line_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace sightline
