#pragma once
#include <vector>

#include "core/draw/box_guard.h"
#include "core/draw/cull_method.h"
#include "core/draw/drawables.h"
#include "core/draw/schedule.h"

namespace sightline {

/// What a method has decided to draw and to ask in a frame, until it is submitted; and the frame's counts.
///
/// Opaque drawables wait in the render queue for the next submit. Masked and blended ones wait for the
/// frame's end, so that no query takes them for what hides (thesis 4.3): masked ones are drawn in the reverse
/// of the order in which they were found, then blended ones, the farthest first. Far is the distance of the
/// box's middle along `forward`; of equally far ones that with the higher index comes first. So every method
/// draws the blended ones in one order.
class FrameRecorder {
 public:
  /// Begins the frame. drawn: gets what is drawn, in order.
  FrameRecorder(const Drawables& drawables, const Camera& camera, QueryBackend& backend,
                std::vector<uint32_t>& drawn, const Schedule& schedule = {});

  /// Puts a drawable into the queue of its kind. At most once a frame.
  void draw(uint32_t drawable);

  /// Adds a query of boxes that BoxGuard has grown to the next submit. Returns its place in it, from 0.
  uint32_t ask(std::span<const AxisBox> boxes);
  uint32_t ask(const AxisBox& box) { return ask({&box, 1}); }

  bool asksAnything() const { return !asked_ends_.empty(); }
  bool drawsAnything() const { return !render_queue_.empty(); }

  /// Submits the queries asked for, after the render queue unless `draws` is false. Returns the first one's
  /// id; what it returns without queries means nothing. Nothing to submit: does not.
  QueryId submit(bool draws = true);

  /// Whether the answer has arrived, by the schedule. ticks: since its submit, of Schedule::ticks. To be
  /// asked at each tick: by the live schedule, who has looked in vain looks again some ticks later only, as
  /// looking costs as much as a visit.
  /// now: looks in any case.
  bool arrived(QueryId query, uint64_t ticks, bool now = false);

  /// The answer, waited for. A wait is counted where it has not arrived or, by the fixed schedule, for the
  /// first answer of each submit.
  bool visible(QueryId query);

  /// Draws all that waits and ends the frame. Queries asked for go with it.
  QueryId finish();

  FrameCounts
      counts;  ///< submits, draws, objects, triangles, queries, query_boxes and waits are counted here

  const BoxGuard& guard() const { return guard_; }
  QueryBackend& backend() { return backend_; }

 private:
  void submitNow(const std::vector<uint32_t>& draws);
  void sortBlended();

  const Drawables& drawables_;
  const Camera& camera_;
  QueryBackend& backend_;
  BoxGuard guard_;
  std::vector<uint32_t>& drawn_;
  std::vector<uint32_t> render_queue_, masked_, blended_;
  std::vector<AxisBox> asked_boxes_;     ///< of all queries that wait
  std::vector<uint32_t> asked_ends_;     ///< in asked_boxes_, one past the last of each query
  std::vector<OcclusionQuery> queries_;  ///< of the last submit; kept for its memory
  uint32_t ticks_to_look_ = 0;           ///< until the next look at whether an answer is there
  Schedule schedule_;
  QueryId submitted_ = 0;             ///< the first query of the last submit
  QueryId waited_for_ = 0;            ///< queries with lower numbers have been waited for
  std::vector<QueryId> submit_ends_;  ///< one past the last query of each submit, ascending
};

}  // namespace sightline
