#pragma once
#include <cstdint>
#include <span>

#include "bvh/axis_box.h"
#include "core/shared/camera.h"

namespace sightline {

/// Whether anything of some boxes shows: would a pixel of their faces, from both sides, be at least as near
/// as what has been drawn there? Boxes are drawn as they are given; whoever asks has grown them
/// (core/draw/box_guard.h) and made sure that they lie behind the near plane.
struct OcclusionQuery {
  std::span<const AxisBox> boxes;  ///< read during submit only
};

/// Number of a query: 0, 1, 2 ... over the backend's life, in the order of submission.
using QueryId = uint64_t;

/// Draws and answers queries: a device (core/draw/vulkan), or the processor (core/draw/software_backend.h).
/// One thread at a time. Drawables are those that the backend was made with, by index.
///
/// Order within a frame: what submits do happens one after another. Draws of one submit come before its
/// queries, and those before the next submit's draws. A drawable of kind opaque or masked writes depth where
/// it is nearer than (not as near as) what is there; blended ones and queries write none.
class QueryBackend {
 public:
  virtual ~QueryBackend() = default;

  /// Starts a frame: nothing is drawn yet. The camera's size may differ from the last frame's.
  virtual void beginFrame(const Camera& camera) = 0;

  /// Draws, then asks. Either may be empty, not both: a submit costs. Returns the first query's id; the
  /// others' follow.
  virtual QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) = 0;

  /// Draws the triangles of a list (core/draw/triangle_lists.h), those that the backend was made with, in its
  /// order and by a draw a kind, in a submit of its own.
  virtual void submitList(uint32_t list) = 0;

  /// Whether the answer can be had without waiting. Queries of a submit arrive in their order. Never waits.
  virtual bool arrived(QueryId query) = 0;

  /// The answer; waits for it. Valid until the end of the frame after the one that asked.
  virtual bool visible(QueryId query) = 0;

  /// Ends the frame. Answers that nobody has waited for may still be on their way.
  virtual void endFrame() = 0;
};

}  // namespace sightline
