#include <deque>

#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"
#include "core/draw/node_queue.h"
#include "core/draw/visit_states.h"

namespace sightline {

namespace {

/// One frame.
class ChcTraversal {
 public:
  ChcTraversal(const DrawScene& scene, VisitStates& states, FrameRecorder& frame, const Camera& camera,
               uint64_t number)
      : tree_(scene.tree), states_(states), frame_(frame), number_(number), nodes_(scene.tree, camera) {
    if (!tree_.nodes.empty()) nodes_.push(0);
  }

  void run() {
    while (!nodes_.empty() || !asked_.empty()) {
      while (!asked_.empty() &&
             (nodes_.empty() || frame_.arrived(asked_.front().query, ticks_ - asked_.front().tick))) {
        answer();
      }
      if (nodes_.empty()) continue;
      ++ticks_;
      visit(nodes_.pop());
    }
    frame_.finish();
  }

 private:
  struct Asked {
    QueryId query;
    uint32_t node;
    bool drawn;  ///< a leaf that was visible and is drawn already
    uint64_t tick;
  };

  void answer() {
    const Asked asked = asked_.front();
    asked_.pop_front();
    if (!frame_.visible(asked.query)) return;
    states_.pullUp(asked.node);
    if (!asked.drawn) open(asked.node);
  }

  void visit(uint32_t index) {
    ++frame_.counts.node_visits;
    const BoxNode& node = tree_.nodes[index];
    if (!states_.mayShow(index, frame_.guard().frustum())) return;
    const bool was_visible = states_.visit(index, number_);
    const auto grown = frame_.guard().grown(node.box);
    if (!grown) {
      states_.pullUp(index);
      return open(index);
    }
    if (was_visible && !node.isLeaf()) return open(index);
    // Drawn before it is asked about, or its own triangles would come too late to hide others.
    if (was_visible) {
      open(index);
      ++frame_.counts.retest_queries;
    }
    frame_.ask(*grown);
    asked_.push_back({frame_.submit(), index, was_visible, ticks_});
  }

  void open(uint32_t index) {
    const BoxNode& node = tree_.nodes[index];
    if (node.isLeaf()) {
      frame_.draw(node.item);
    } else {
      nodes_.pushChildren(index);
    }
  }

  const BoxTree& tree_;
  VisitStates& states_;
  FrameRecorder& frame_;
  uint64_t number_;
  NodeQueue nodes_;
  std::deque<Asked> asked_;
  uint64_t ticks_ = 0;
};

class ChcCulled : public CullMethod {
 public:
  ChcCulled(const DrawScene& scene, const Schedule& schedule)
      : scene_(scene), schedule_(schedule), states_(scene.tree) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn, schedule_);
    ChcTraversal(scene_, states_, frame, camera, number).run();
    return frame.counts;
  }
  void forget() override { states_.forget(); }

 private:
  const DrawScene& scene_;
  Schedule schedule_;
  VisitStates states_;
};

}  // namespace

std::unique_ptr<CullMethod> cullChc(const DrawScene& scene, const Schedule& schedule) {
  return std::make_unique<ChcCulled>(scene, schedule);
}

}  // namespace sightline
