#pragma once
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/bake/report.h"
#include "core/walk/replay.h"

namespace sightline {

/// A method that was asked for by `all` and not replayed.
struct LeftOutMethod {
  std::string name, why;
};

/// A cell of the set.
struct WalkedCell {
  std::string name;
  uint64_t triangles = 0;  ///< in its set
};

/// Everything that `sightline walk` found.
struct WalkReport {
  std::string version;
  SceneSummary scene;
  std::string path;                    ///< file, or "views:CELL"
  std::string pvs;                     ///< file; empty: none
  std::vector<WalkedCell> cells = {};  ///< of that file
  DeviceInfo device;
  std::string tracer;  ///< id of the device that traced; empty: nothing was
  bool gpu_times = false;
  uint32_t width = 0, height = 0;
  double fov = 0;  ///< degrees from top to bottom
  uint64_t drawables = 0;
  uint32_t split = 0;
  std::string chain = {};  ///< of submits: "barriers", "semaphores"; empty: there are none
  WalkFrames frames;
  ReplayOptions options;
  std::vector<LeftOutMethod> left_out;
  WalkReplay replay;
};

/// A method over a range of frames. What no frame was measured of stays 0.
struct WalkSummary {
  uint64_t timed = 0, gpu_timed = 0, counted = 0, checked = 0;  ///< frames that what is below is of
  double mean = 0, median = 0;                                  ///< milliseconds a frame
  double slowest_1 = 0, slowest_01 = 0;  ///< mean of the slowest hundredth and thousandth, one frame at least
  double gpu = 0;                        ///< mean milliseconds of FrameTimes::gpu_frame
  double cpu = 0;                        ///< of the processor's parts but the waits
  double objects = 0, triangles = 0, queries = 0, submits = 0, waits = 0;  ///< means a frame
  uint64_t outside = 0;                                                    ///< frames outside all cells
  uint64_t false_pixels = 0, false_frames = 0, near_pixels = 0, most_false = 0;
  uint64_t largest_region = 0, behind_alpha = 0;  ///< CheckedFrame: the largest of all, and all
};
/// Frames begin .. end - 1, as far as there are any.
WalkSummary summarize(const MethodReplay& method, size_t begin, size_t end);

/// The frames between two cuts.
struct WalkStretch {
  uint32_t begin = 0, end = 0;
};
std::vector<WalkStretch> stretchesOf(const WalkFrames& frames);

/// The frames of views out of a cell.
struct CellStretch {
  uint32_t cell = 0;  ///< in WalkReport::cells
  WalkStretch frames;
};
/// In the order of frames; none where they are not views out of cells.
std::vector<CellStretch> cellStretchesOf(const WalkFrames& frames);

/// "pvs, pvs+vfc are left out: why", a line a reason.
std::vector<std::string> leftOutLines(const WalkReport& report);

/// What a reader of the numbers must know, a line each: times that are only of a warm-up; a device that draws
/// what no ray meets.
std::vector<std::string> walkNotes(const WalkReport& report);

/// For people: a line a method.
std::string walkTable(const WalkReport& report);
/// docs/walk.md.
Json walkJson(const WalkReport& report);
/// A line a method and frame.
std::string walkCsv(const WalkReport& report);

/// Exact methods with more false pixels than allowed, a line each.
std::vector<std::string> pastFalse(const WalkReport& report, uint64_t max_false);

}  // namespace sightline
