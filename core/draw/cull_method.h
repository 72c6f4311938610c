#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "core/draw/query_backend.h"

namespace sightline {

/// What a method did in a frame. All start at 0.
struct FrameCounts {
  uint64_t submits = 0;         ///< that drew or asked anything
  uint64_t draws = 0;           ///< draw calls: drawables and lists
  uint64_t objects = 0;         ///< drawables drawn, each once; of a list those with a triangle in it
  uint64_t triangles = 0;       ///< drawn
  uint64_t queries = 0;         ///< all of them
  uint64_t multi_queries = 0;   ///< of these, of more than one node
  uint64_t failed_queries = 0;  ///< multiqueries that were visible, so that their nodes were asked one by one
  uint64_t retest_queries = 0;  ///< of leaves that were drawn before (v-queue)
  uint64_t query_boxes = 0;     ///< boxes drawn for queries
  uint64_t node_visits = 0;     ///< nodes taken from the queue, or met going down
  uint64_t waits = 0;    ///< times that the method stopped for an answer; by the fixed schedule once a submit
                         /// < whose answers were asked for, so that it does not depend on a clock
  bool outside = false;  ///< pvs: the camera was in no cell

  bool operator==(const FrameCounts&) const = default;
};

/// Decides what of the drawables is drawn in each frame. It speaks to a QueryBackend only: it knows no
/// device, no clock and no generator of its own. The same frames and the same answers, arriving alike, give
/// the same draws and counts. One thread at a time.
class CullMethod {
 public:
  virtual ~CullMethod() = default;

  /// Draws one frame, beginFrame to endFrame included. number: of the frame, one more than the last call's
  /// unless frames are left out; coherence is between a frame and the one with the number before. drawn: gets
  /// the drawables drawn, in order, each once (of a list those with a triangle in it).
  virtual FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                                std::vector<uint32_t>& drawn) = 0;

  /// Forgets all frames, as if just made: for the next repeat of a replay.
  virtual void forget() = 0;
};

}  // namespace sightline
