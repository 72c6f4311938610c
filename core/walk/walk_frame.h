#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/draw/cull_method.h"

namespace sightline {

/// What the processor's time in a frame goes to.
enum class CpuPart {
  traverse,  ///< the method's own thinking
  record,    ///< of commands
  submit,
  wait,  ///< for answers
  idle,  ///< until the frames before are done, so that no more than asked for are in flight
};
inline constexpr size_t kCpuPartCount = 5;
inline constexpr std::array<const char*, kCpuPartCount> kCpuPartNames = {
    "traverse", "record", "submit", "wait for queries", "wait for frames"};

/// What the GPU's time in a frame goes to; rest: between submits.
inline constexpr size_t kGpuPartCount = 5;
inline constexpr std::array<const char*, kGpuPartCount> kGpuPartNames = {"draw", "query", "pyramid", "cull",
                                                                         "rest"};

/// Times of a frame in milliseconds. GPU times that are not known are 0: of a device without a GPU, or that
/// was lost.
struct FrameTimes {
  double frame = 0;  ///< from its beginning to that of the next
  std::array<double, kCpuPartCount> cpu{};
  std::array<double, kGpuPartCount> gpu{};
  double gpu_frame = 0;  ///< from its first command to the end of its last
};

/// When the parts of a frame were worked on, in milliseconds since the processor began it. Of both in order;
/// empty where they are not known.
struct WalkFrameSpans {
  template <typename Part>
  struct Span {
    Part part;
    double begin = 0, end = 0;
  };
  std::vector<Span<CpuPart>> cpu;
  /// By kGpuPartNames. From the first submit on: the GPU's own clock starts no earlier.
  std::vector<Span<size_t>> gpu;

  bool empty() const { return cpu.empty() && gpu.empty(); }
};

/// How a frame differs from one that draws everything, bit by bit in depth.
struct FrameCheck {
  struct Missing {
    uint32_t drawable = 0;
    uint64_t pixels = 0;  ///< that should show it, and show what is behind
    bool operator==(const Missing&) const = default;
  };
  uint64_t false_pixels = 0;     ///< farther away than they should be, by however little
  uint64_t near_pixels = 0;      ///< nearer: always 0, or the device draws the same in two ways
  std::vector<Missing> missing;  ///< by drawable
  std::vector<uint32_t> shown;   ///< drawables with a pixel that should show them, ascending

  uint64_t largest() const {
    uint64_t most = 0;
    for (const Missing& m : missing) most = m.pixels > most ? m.pixels : most;
    return most;
  }
};

}  // namespace sightline
