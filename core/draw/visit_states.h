#pragma once
#include <vector>

#include "bvh/box_tree.h"
#include "core/draw/frustum.h"

namespace sightline {

/// What a method of the CHC family remembers of a node.
struct VisitState {
  uint64_t visited = 0;  ///< frame of the last visit, plus one; 0: never
  bool visible =
      false;  ///< in that frame, as far as is known: of inner nodes by what is below (pull-up) alone
  bool inside = false;  ///< the image's sides cut nothing off its box, nor what is in it, in that frame
  uint32_t hidden_frames = 0;  ///< so many answers in a row were "hidden"
  uint64_t next_test = 0;      ///< leaves: the frame in which to ask again while it stays visible
  AxisBox grown;  ///< its box (BoxGuard), in the frame of the last visit, if it can be asked about
};

/// The states of all nodes.
class VisitStates {
 public:
  explicit VisitStates(const BoxTree& tree) : tree_(tree) { forget(); }

  void forget() { states_.assign(tree_.nodes.size(), {}); }
  VisitState& operator[](uint32_t node) { return states_[node]; }

  /// Whether the image may show the node. The one above has been asked about in this frame.
  bool mayShow(uint32_t node, const Frustum& frustum) {
    const BoxNode& box_node = tree_.nodes[node];
    VisitState& state = states_[node];
    state.inside = box_node.parent != kNoBoxNode && states_[box_node.parent].inside;
    if (state.inside) return true;
    const FrustumSide side = frustum.sideOf(box_node.box);
    state.inside = side == FrustumSide::inside;
    return side != FrustumSide::outside;
  }

  /// Begins the node's visit; returns whether it was visible in the frame before.
  bool visit(uint32_t node, uint64_t frame) {
    VisitState& state = states_[node];
    const bool was_visible = state.visible && state.visited == frame;
    state.visited = frame + 1;
    state.visible = false;
    return was_visible;
  }

  /// The node is visible, and so are those above it. All have been visited in this frame.
  void pullUp(uint32_t node) {
    while (node != kNoBoxNode && !states_[node].visible) {
      states_[node].visible = true;
      node = tree_.nodes[node].parent;
    }
  }

 private:
  const BoxTree& tree_;
  std::vector<VisitState> states_;
};

}  // namespace sightline
