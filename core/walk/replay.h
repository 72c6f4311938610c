#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/trace/tracer.h"
#include "core/walk/walk_device.h"

namespace sightline {

/// The frames that every method draws.
struct WalkFrames {
  std::vector<Camera> cameras;
  std::vector<uint32_t> cuts;  ///< frames to which the camera jumps, ascending; the first frame is none
  /// Views out of cells of a set: of each frame the cell, whose set is drawn; empty: the camera's cell is.
  std::vector<uint32_t> cells = {};
};

struct ReplayOptions {
  uint32_t repeats = 3;       ///< of the whole walk by each method, that count; one more is dropped before
  uint32_t in_flight = 2;     ///< frames under way at once, 1 or more: 1 shows latency, 2 throughput
  bool check = true;          ///< compare each frame with one that draws everything
  uint32_t trace_every = 50;  ///< frames from one that is traced to the next; 0: none is
  uint32_t kept_frames = 3;   ///< of each method the worst frames whose false pixels are kept
  std::vector<uint32_t> shown_frames = {};  ///< of which it is kept what was drawn
  WalkMethodOptions method = {};
};

/// A frame's comparison with one that draws everything.
struct CheckedFrame {
  uint64_t false_pixels = 0, near_pixels = 0;
  uint64_t largest = 0;                                   ///< most false pixels of one drawable
  uint64_t missing = 0;                                   ///< drawables with false pixels
  uint64_t optimal_drawables = 0, optimal_triangles = 0;  ///< with a pixel, and all triangles of those
  uint64_t largest_region = 0;  ///< most false pixels that touch each other, at corners too
  uint64_t behind_alpha = 0;    ///< false pixels that show what is behind holes or glass (AlphaCover)
  bool operator==(const CheckedFrame&) const = default;
};

/// A drawable that was to be seen and was not, for some frames in a row.
struct Pop {
  uint32_t drawable = 0;
  uint32_t first_frame = 0, frames = 0;
  uint64_t most_pixels = 0;  ///< false in one of them
  bool operator==(const Pop&) const = default;
};

/// A frame with false pixels.
struct FalseFrame {
  uint32_t frame = 0;
  std::vector<size_t> pixels;  ///< their numbers, row by row, ascending
};

/// The slowest frame of all repeats of a method.
struct SlowestFrame {
  uint32_t frame = 0;
  double milliseconds = 0;  ///< 0: there was none
  WalkFrameSpans spans = {};
};

/// What one method did. Lists are by frame, and shorter than the walk where it was stopped.
struct MethodReplay {
  std::string name;
  uint32_t repeats = 0;  ///< whole ones, of which times are medians; 0: of a part of one
  bool warm_up = false;  ///< times are of the replay that is dropped, as it was stopped before any other
  std::vector<FrameTimes> times = {};  ///< empty: it was not run
  SlowestFrame slowest = {};
  std::vector<FrameCounts> counts = {};
  std::vector<CheckedFrame> checks = {};          ///< empty: not checked
  std::vector<Pop> pops = {};                     ///< the longest first, at most kMostPops
  uint64_t pop_count = 0;                         ///< all
  std::vector<FalseFrame> worst = {};             ///< most false pixels first
  std::vector<std::vector<uint32_t>> drawn = {};  ///< drawables, of ReplayOptions::shown_frames
};
inline constexpr size_t kMostPops = 10;

/// A frame's rays, one a pixel, traced: the fewest triangles that it takes, by means that share nothing with
/// drawing.
struct TracedFrame {
  uint32_t frame = 0;
  double milliseconds = 0;
  uint64_t drawables = 0, triangles = 0, drawable_triangles = 0;  ///< OptimalCounts
  uint64_t other_pixels = 0;  ///< that show another drawable than the frame that draws everything
  /// Of these, where no ray within 1/128 pixel meets what was drawn: 0, or tracer and device differ in more
  /// than the rounding of corners.
  uint64_t unexplained_pixels = 0;
};

struct WalkReplay {
  std::vector<MethodReplay> methods;
  std::vector<TracedFrame> traced;
  bool alpha = false;    ///< something in the scene has holes or is glass
  bool complete = true;  ///< false: stopped, or `problem`
  std::string problem;   ///< what ended it, in a line; empty: nothing
  int problem_code = 0;  ///< exit code for it
  double seconds = 0;
};

struct ReplayProgress {
  const std::string& method;
  const char* pass;  ///< "warm-up", "repeat 2 of 3", "check"
  uint32_t frame, frames;
  uint64_t done, all;  ///< frames of all passes
};

struct ReplayHooks {
  std::function<void(const ReplayProgress&)> progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< ends it in order; what has been found stays
};

/// Replays whole walks by each method: first once each, which is dropped, then `repeats` times, the order of
/// methods rotated by one each time; times are medians by frame. Then, in a pass of its own, counts what
/// methods on the GPU did, and checks each frame. tracer: of the scene; nullptr: nothing is traced. Whatever
/// ends it early (ReplayHooks::stop, a lost device, OutsideCells::error) is in the result with the frames so
/// far. Throws Error only where no method can be made.
WalkReplay replayWalk(WalkDevice& device, const WalkScene& scene, const WalkFrames& frames,
                      const std::vector<std::string>& methods, const ReplayOptions& options, Tracer* tracer,
                      const WalkClock& clock, const ReplayHooks& hooks = {});

/// The ray through the middle of a pixel, moved by shares of a pixel.
Ray pixelRay(const Camera& camera, uint32_t x, uint32_t y, double right = 0, double down = 0);

}  // namespace sightline
