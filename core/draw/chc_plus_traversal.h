#pragma once
#include <deque>
#include <span>
#include <vector>

#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"
#include "core/draw/node_queue.h"
#include "core/draw/visit_states.h"

namespace sightline {

/// One frame of CHC++ (cullChcPlus).
///
///   node queue --> hidden before --> i-queue --multiqueries--> asked --visible--> children, or render queue
///        ^    \                                     ^            |
///        |     `-> visible before: render queue     |   failed: c-queue
///        |          `-> due for a re-test: v-queue -'            |
///        `------------------- children --------------------------'
class ChcPlusTraversal {
 public:
  /// number: of the frame.
  ChcPlusTraversal(const DrawScene& scene, const ChcOptions& options, uint64_t seed, VisitStates& states,
                   FrameRecorder& frame, const Camera& camera, uint64_t number);

  /// Draws the frame and ends it.
  void run();

 private:
  /// A query that has been submitted.
  struct Asked {
    QueryId query = 0;
    uint32_t first_node = 0, node_count = 0;  ///< in asked_nodes_
    bool retest = false;                      ///< of a leaf that was visible, and is drawn already
    uint64_t tick = 0;                        ///< of its submit
  };

  void checkQueries();
  void fillWait();
  bool firstArrived(bool now = false);
  void handleFirst();
  void visit(uint32_t index);
  void open(uint32_t index);
  void becomeVisible(uint32_t index);
  void issueMultiQueries();
  void endFrame();
  void beginBatch();
  /// nodes: not of asked_nodes_.
  void ask(std::span<const uint32_t> nodes, bool retest);
  void ask(uint32_t node, bool retest) { ask({&node, 1}, retest); }
  void submitAsked(bool draws = true);
  void placeAsked(QueryId first);
  uint64_t jitter(uint32_t node) const;

  const BoxTree& tree_;
  const ChcOptions& options_;
  uint64_t seed_;
  VisitStates& states_;
  FrameRecorder& frame_;
  uint64_t number_;
  NodeQueue nodes_;
  std::deque<uint32_t> v_queue_;
  std::vector<uint32_t> i_queue_, c_queue_;
  std::vector<uint32_t> asked_nodes_;  ///< of all queries of the frame
  std::vector<AxisBox> boxes_;         ///< of the last query; kept for its memory
  std::deque<Asked> asked_;
  std::vector<Asked> asking_;  ///< recorded for the next submit
  uint64_t ticks_ = 0;
};

}  // namespace sightline
