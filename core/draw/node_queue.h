#pragma once
#include <queue>
#include <vector>

#include "bvh/box_tree.h"
#include "core/shared/camera.h"

namespace sightline {

/// Square of the distance from the eye to the box, 0 inside of it. A box in a box is never nearer.
double squaredDistance(const Camera& camera, const AxisBox& box);

/// Nodes of a tree, the nearest first; of equally near ones that with the lower number.
class NodeQueue {
 public:
  NodeQueue(const BoxTree& tree, const Camera& camera) : tree_(tree), camera_(camera) {}

  void push(uint32_t node) { queue_.push({squaredDistance(camera_, tree_.nodes[node].box), node}); }
  void pushChildren(uint32_t node) {
    for (const uint32_t child : tree_.nodes[node].children) push(child);
  }
  /// The queue must not be empty.
  uint32_t pop() {
    const uint32_t node = queue_.top().node;
    queue_.pop();
    return node;
  }
  bool empty() const { return queue_.empty(); }

 private:
  struct Entry {
    double distance;
    uint32_t node;
    bool operator<(const Entry& other) const {  // the greatest comes first
      return distance != other.distance ? distance > other.distance : node > other.node;
    }
  };
  const BoxTree& tree_;
  const Camera& camera_;
  std::priority_queue<Entry> queue_;
};

}  // namespace sightline
