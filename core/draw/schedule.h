#pragma once
#include <cstdint>

namespace sightline {

/// When answers count as arrived, and what is random.
struct Schedule {
  /// false (live): when the backend says so; what is drawn and asked then depends on the device's speed.
  /// true: after so many ticks since their submit, or when there is nothing else to do; the method then
  /// really waits. The same frames give the same draws and counts wherever queries are answered alike.
  bool fixed = false;
  uint32_t ticks = 16;  ///< a tick is a node taken from the queue, or a re-test recorded in the meantime
  uint64_t seed =
      1;  ///< of the jitter (ChcOptions::assumed_frames), which depends on seed, node and frame only
};

}  // namespace sightline
