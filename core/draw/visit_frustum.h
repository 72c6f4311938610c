#pragma once
#include <utility>

#include "bvh/box_tree.h"
#include "core/draw/frustum.h"
#include "core/draw/node_queue.h"

namespace sightline {

/// Calls visit(leaf) for the leaves that the image may show, nearer children first. Returns the nodes met.
template <typename Visit>
uint64_t visitFrustum(const BoxTree& tree, const Camera& camera, const Frustum& frustum, Visit&& visit) {
  if (tree.nodes.empty()) return 0;
  uint64_t visits = 0;
  struct Entry {
    uint32_t node;
    bool inside;  ///< its parent is: no more tests
  };
  std::vector<Entry> stack{{0, false}};
  while (!stack.empty()) {
    auto [index, inside] = stack.back();
    stack.pop_back();
    ++visits;
    const BoxNode& node = tree.nodes[index];
    if (!inside) {
      const FrustumSide side = frustum.sideOf(node.box);
      if (side == FrustumSide::outside) continue;
      inside = side == FrustumSide::inside;
    }
    if (node.isLeaf()) {
      visit(node);
      continue;
    }
    auto [near, far] = std::pair(node.children[0], node.children[1]);
    if (squaredDistance(camera, tree.nodes[far].box) < squaredDistance(camera, tree.nodes[near].box)) {
      std::swap(near, far);
    }
    stack.push_back({far, inside});
    stack.push_back({near, inside});
  }
  return visits;
}

}  // namespace sightline
