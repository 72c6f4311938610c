#pragma once
#include <algorithm>
#include <map>
#include <span>

#include "core/walk/replay.h"

namespace sightline {

/// Finds how many frames in a row drawables were missing.
class PopWatch {
 public:
  /// The next frame, and what is missing in it: by drawable, ascending or not, each once.
  void frame(uint32_t number, std::span<const FrameCheck::Missing> missing) {
    std::map<uint32_t, Pop> now;
    for (const FrameCheck::Missing& m : missing) {
      const auto before = open_.find(m.drawable);
      Pop pop = before == open_.end() ? Pop{m.drawable, number, 0, 0} : before->second;
      if (before != open_.end()) open_.erase(before);
      ++pop.frames;
      pop.most_pixels = std::max(pop.most_pixels, m.pixels);
      now.emplace(m.drawable, pop);
    }
    close();
    open_ = std::move(now);
  }

  /// After the last frame.
  void end(MethodReplay& into) {
    close();
    into.pops = longest_;
    into.pop_count = count_;
  }

 private:
  /// Those that are open have ended.
  void close() {
    for (const auto& [drawable, pop] : open_) {
      ++count_;
      longest_.push_back(pop);
    }
    open_.clear();
    std::ranges::stable_sort(longest_, [](const Pop& a, const Pop& b) {
      return a.frames != b.frames ? a.frames > b.frames : a.most_pixels > b.most_pixels;
    });
    if (longest_.size() > kMostPops) longest_.resize(kMostPops);
  }

  std::map<uint32_t, Pop> open_;  ///< missing in the last frame
  std::vector<Pop> longest_;
  uint64_t count_ = 0;
};

}  // namespace sightline
